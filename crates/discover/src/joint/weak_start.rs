//! A support to start the joint search from: what the weak form finds, equation by equation.
//!
//! In: a model, its libraries, a dataset, the estimation problem. Out: columns with coefficients, or nothing. The weak form sees noise
//! less well than the likelihood does, but costs a hundredth of a search. Decides nothing: the search fits the start and judges it.

use crate::known_terms::fixed_terms;
use crate::options::{Method, Options};
use crate::regression::task::Task;
use crate::regression::thresholds::WEAK_FORM;
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
    of: (&Model, &[Option<Library>]),
    dataset: &Dataset,
    problem: &Problem,
    options: &Options,
    watcher: &mut EquationObserver,
) -> Option<StartingSupport> {
    if !problem.system.hidden.is_empty() || !problem.system.resets.is_empty() {
        // The weak form needs readings of every state, and integrals that cross no jump.
        return problem.proposed_columns();
    }
    from_weak_form(of, (dataset, problem), options, |weak| {
        all_columns(problem, &weak.terms(watcher))
    })?
}

/// The columns of all laws that the weak form selects before it iterates, at several prices of a term; different ones only. Empty where
/// there would be no [`weak_start`]. For a start these serve better than what iteration makes of them: along the smoothed readings it adds
/// terms that explain their errors.
pub(crate) fn weak_guesses(
    of: (&Model, &[Option<Library>]),
    dataset: &Dataset,
    problem: &Problem,
    options: &Options,
    watcher: &mut EquationObserver,
) -> Vec<StartingSupport> {
    let guesses = from_weak_form(of, (dataset, problem), options, |weak| {
        weak.guesses(&WEAK_FORM.penalty_factors, watcher)
    });
    let guesses = guesses.unwrap_or_default().into_iter();
    let mut guesses: Vec<StartingSupport> = guesses
        .filter_map(|guess| all_columns(problem, &guess.terms))
        .collect();
    guesses.dedup_by(|a, b| a.iter().map(|t| t.0).eq(b.iter().map(|t| t.0)));
    guesses
}

/// The criterion of the first of these guesses, by which values of constants can be compared; infinite where there is none.
pub(crate) fn value_of_weak_guess(
    of: (&Model, &[Option<Library>]),
    dataset: &Dataset,
    problem: &Problem,
    options: &Options,
    watcher: &mut EquationObserver,
) -> f64 {
    let guesses = from_weak_form(of, (dataset, problem), options, |weak| {
        weak.guesses(&WEAK_FORM.penalty_factors[..1], watcher)
    });
    let first = guesses.and_then(|all| all.into_iter().next());
    first.map_or(f64::INFINITY, |guess| guess.value)
}

/// What `work` makes of the weak form of all laws that are searched.
fn from_weak_form<A>(
    (model, libraries): (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    options: &Options,
    work: impl FnOnce(WeakSystem) -> A,
) -> Option<A> {
    let options = &Options {
        method: Method::Weak,
        ..*options
    };
    // Its integrals would cross the jumps of the states.
    if !problem.system.resets.is_empty() {
        return None;
    }
    if problem.searched_in_parts() || !problem.run_columns.is_empty() {
        return None;
    }
    if searched(problem).any(|l| l.columns.len() > TERM_SELECTION.exhaustive_columns) {
        return None;
    }
    let known: Vec<(&Law, Vec<(f64, Term)>)> = searched(problem)
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
    Some(work(WeakSystem::new(tasks).ok()?))
}

fn searched(problem: &Problem) -> impl Iterator<Item = &Law> {
    let laws = problem.system.laws.iter();
    laws.filter(|l| !l.columns.is_empty())
}

/// The columns of all laws, from the terms of each equation; `None` if one lacks.
fn all_columns(problem: &Problem, found: &[(usize, SlotTerms)]) -> Option<StartingSupport> {
    let mut start = StartingSupport::new();
    for law in searched(problem) {
        let own = found.iter().find(|(place, _)| *place == law.equation);
        start.extend(columns(law, &own?.1)?);
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
