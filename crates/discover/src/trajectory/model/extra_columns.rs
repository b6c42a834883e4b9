//! More candidate columns for the laws of a problem.
//!
//! In: a problem, terms for each law. Out: the same problem with these columns after its own. Signals stay those of the problem.

use super::estimation_problem::{LinearizationPoint, Problem};
use sidc_lang::term::Term;

/// A problem with more columns, and where each of its columns comes from.
pub(crate) struct ExtendedProblem {
    pub problem: Problem,
    /// For each column its place in the original problem; `None` for a new one.
    pub origin: Vec<Option<usize>>,
}

impl Problem {
    /// The problem with `extra[l]` added to the columns of law l. Terms of signals that the problem does not have are left out,
    /// and those without a finite value along the smoothed trajectories.
    pub(crate) fn with_extra_columns(&self, extra: &[Vec<Term>]) -> ExtendedProblem {
        let signals = self.system.evaluation_signals();
        let known = |t: &&Term| {
            let mut all = true;
            t.for_each_signal(&mut |s| all &= signals.contains(&s));
            all
        };
        let usable: Vec<Vec<Term>> = (extra.iter())
            .map(|law| law.iter().filter(known).cloned().collect())
            .collect();
        let whole = self.extended(&usable);
        let bad = whole.problem.undefined_columns();
        let defined = |law: usize, term: &Term| {
            let columns = &whole.problem.system.laws[law].columns;
            let mut at = columns.clone();
            !at.any(|j| bad.contains(&j) && whole.problem.system.columns[j] == *term)
        };
        let defined: Vec<Vec<Term>> = (usable.iter().enumerate())
            .map(|(l, law)| law.iter().filter(|t| defined(l, t)).cloned().collect())
            .collect();
        self.extended(&defined)
    }

    fn extended(&self, extra: &[Vec<Term>]) -> ExtendedProblem {
        let mut problem = self.clone();
        let system = &mut problem.system;
        let before = std::mem::take(&mut system.columns);
        let mut origin = Vec::new();
        for (l, law) in system.laws.iter_mut().enumerate() {
            let from = system.columns.len();
            let own = law.columns.clone();
            origin.extend(own.clone().map(Some));
            system.columns.extend_from_slice(&before[own]);
            for term in extra.get(l).into_iter().flatten() {
                origin.push(None);
                system.columns.push(term.clone());
                law.written.push(false);
            }
            law.columns = from..system.columns.len();
        }
        let place = |column: usize| origin.iter().position(|o| *o == Some(column));
        system.constraints = system.constraints.renumbered(&place);
        problem.run_columns = self.run_columns.moved(&origin);
        problem.compile_columns();
        ExtendedProblem { problem, origin }
    }
}

impl ExtendedProblem {
    /// A point of the original problem, with the numbers that its columns have now.
    pub fn point(&self, of: &LinearizationPoint) -> LinearizationPoint {
        let place = |j: &usize| self.origin.iter().position(|o| *o == Some(*j));
        LinearizationPoint {
            support: of.support.iter().filter_map(place).collect(),
            ..of.clone()
        }
    }
}
