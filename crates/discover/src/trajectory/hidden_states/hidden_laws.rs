//! Which laws are those of hidden states.
//!
//! In: a problem. Out: the places of laws. Changes nothing.

use crate::trajectory::model::Problem;

/// The hidden laws of a problem: those that are given, and those with columns.
pub(super) fn hidden_laws(problem: &Problem) -> (Vec<usize>, Vec<usize>) {
    let laws = problem.system.laws.iter().enumerate();
    let hidden = laws.filter(|(_, law)| problem.system.is_hidden(law.state));
    let (given, sought): (Vec<_>, Vec<_>) = hidden.partition(|(_, law)| law.columns.is_empty());
    let place = |laws: Vec<(usize, _)>| laws.into_iter().map(|(l, _)| l).collect();
    (place(given), place(sought))
}
