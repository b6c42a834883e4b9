//! A support to start the joint search from: what the weak form finds, equation by equation.
//!
//! In: a model, its libraries, a dataset, the estimation problem. Out: columns with coefficients, or nothing. The weak form sees noise
//! less well than the likelihood does, but costs a hundredth of a search. Decides nothing: the search fits the start and judges it.

use crate::known_terms::fixed_terms;
use crate::options::{Method, Options};
use crate::regression::task::Task;
use crate::regression::weak_regression::{SlotTerms, WeakSystem};
use crate::selection::thresholds::TERM_SELECTION;
use crate::trajectory::{Law, Problem, StartingSupport};
use sidc_data::{Dataset, Samples};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::Term;
use sidc_progress::EquationObserver;

/// The columns of all laws that the weak form selects. `None` where a law is not found or has more columns than are searched
/// exhaustively, and for records so long that only parts of them are searched,
/// and where coefficients differ between runs.
pub(crate) fn weak_start(
    (model, libraries): (&Model, &[Option<Library>]),
    dataset: &Dataset,
    problem: &Problem,
    options: &Options,
    watcher: &mut EquationObserver,
) -> Option<StartingSupport> {
    let options = &Options {
        method: Method::Weak,
        ..*options
    };
    if !problem.system.hidden.is_empty() {
        // The weak form needs readings of every state.
        return problem.proposed_columns();
    }
    if problem.searched_in_parts() || !problem.run_columns.is_empty() {
        return None;
    }
    let searched = || problem.system.laws.iter().filter(|l| !l.columns.is_empty());
    if searched().next().is_none() {
        return Some(StartingSupport::new());
    }
    if searched().any(|l| l.columns.len() > TERM_SELECTION.exhaustive_columns) {
        return None;
    }
    let known: Vec<(&Law, Vec<(f64, Term)>)> = searched()
        .map(|l| (l, fixed_terms(&model.equations[l.equation].right)))
        .collect();
    let samples = Samples::default();
    let tasks = known.into_iter().filter_map(|(law, known)| {
        let task = Task {
            target: law.target,
            known,
            library: libraries.get(law.equation)?.as_ref()?,
            model,
            dataset,
            samples: &samples,
            options,
        };
        Some((law.equation, task))
    });
    let found = WeakSystem::new(tasks).ok()?.terms(watcher);
    let mut start = StartingSupport::new();
    for law in searched() {
        let own = found.iter().find(|(place, _)| *place == law.equation);
        start.extend(columns(law, own?.1.as_ref()?)?);
    }
    start.sort_unstable_by_key(|(column, _)| *column);
    Some(start)
}

/// The columns of a law that are these slots of its library.
fn columns(law: &Law, terms: &SlotTerms) -> Option<StartingSupport> {
    let column = |slot: &usize| law.slots.iter().position(|s| s == slot);
    let place = |(slot, a): &(usize, f64)| Some((law.columns.start + column(slot)?, *a));
    terms.iter().map(place).collect()
}
