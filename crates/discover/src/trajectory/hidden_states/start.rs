//! The best start for a problem with hidden states.
//!
//! In: a problem with hidden states, values of its constants. Out: the same problem with courses and columns to start from. Proposes none itself.

use super::filtered_course::{Start, filtered_courses};
use super::given_course::given_courses;
use super::hidden_laws::hidden_laws;
use super::observed_fit::observed;
use super::offset::{Offset, sparsest_offsets};
use super::run_fit::hidden_courses_by_runs;
use super::scale::is_free;
use super::solved_course::solved_courses;
use super::thresholds::HIDDEN;
use crate::trajectory::likelihood::{Fit, fit};
use crate::trajectory::model::{HiddenCourse, LinearizationPoint, Problem};
use crate::trajectory::search::{Found, final_criterion};
use sidc_lang::term::Signal;
use sidc_progress::Observer;

/// The problem with courses of its hidden states and columns to start from: of at most `most` proposals the one from which the fit of all
/// laws is best. A fit that did not converge is taken only if no other did, since hidden states without readings may drift.
pub(crate) fn with_started_states(
    problem: &Problem,
    most: usize,
    observer: &mut dyn Observer,
) -> Problem {
    let free = of_free_scale(problem);
    let problem = with_given_courses(problem, &free);
    let Some((mut fit, mut started)) = best_start(&problem, &free, most, observer) else {
        return problem;
    };
    let beat = |fit: &Fit| match fit.converged {
        true => fit.value,
        false => f64::INFINITY,
    };
    while let Some(sparser) = with_fewer_terms((&started, &free), &fit, beat(&fit), observer) {
        (fit, started) = sparser;
    }
    let mut started = started.with_hidden_of(&fit, &free, None);
    started.proposed = Some(fit.point.active());
    started
}

/// An answer in which hidden states are shifted so that the laws have fewer terms, and its problem; `None` where none is better.
pub(crate) fn with_sparsest_offset(
    problem: &Problem,
    found: &Found,
    observer: &mut dyn Observer,
) -> Option<(Problem, Found)> {
    let free = of_free_scale(problem);
    // Values at other prices of a term are not compared.
    let beat = match found.inefficiency == 1.0 {
        true => found.best.value,
        false => f64::INFINITY,
    };
    let (near, shifted) = with_fewer_terms((problem, &free), &found.best, beat, observer)?;
    let better = found.refitted(&shifted, near.point, observer)?;
    let accepted = better.best.converged && better.best.value < found.best.value;
    accepted.then_some((shifted, better))
}

/// A fit of fewer terms and a criterion below `beat`, after an offset of a hidden state by measured ones, and its problem.
fn with_fewer_terms(
    (problem, free): (&Problem, &[usize]),
    fit: &Fit,
    beat: f64,
    observer: &mut dyn Observer,
) -> Option<(Fit, Problem)> {
    let offsets = sparsest_offsets(problem, &fit.point.active());
    offsets.into_iter().find_map(|offset| {
        let shifted = problem.with_hidden_of(fit, free, Some(&offset));
        let (support, coefficients) = offset.terms.into_iter().unzip();
        let point = LinearizationPoint {
            support,
            coefficients,
            ..shifted.initial_point(&shifted.noise)
        };
        let found = tightened(&shifted, point, f64::INFINITY, observer)?;
        (found.converged && found.value < beat).then_some((found, shifted))
    })
}

/// The criterion of the fit from the best start, for long records on segments; infinite where no fit converges.
pub(super) fn value_of_start(problem: &Problem, observer: &mut dyn Observer) -> f64 {
    let free = of_free_scale(problem);
    let short = problem.on_segments();
    let started = with_given_courses(short.as_ref().unwrap_or(problem), &free);
    let best = best_start(&started, &free, HIDDEN.courses_per_value, observer)
        .filter(|(fit, _)| fit.converged);
    best.map_or(f64::INFINITY, |(fit, _)| fit.value)
}

/// The laws of hidden states whose scale is free.
fn of_free_scale(problem: &Problem) -> Vec<usize> {
    let (given, sought) = hidden_laws(problem);
    let all = given.into_iter().chain(sought);
    all.filter(|l| is_free(problem, *l)).collect()
}

fn with_given_courses(problem: &Problem, free: &[usize]) -> Problem {
    let (given, _) = hidden_laws(problem);
    match given_courses(problem, &given).filter(|c| !c.is_empty()) {
        Some(courses) => problem.with_hidden_courses(&courses, free),
        None => problem.clone(),
    }
}

/// The fit from the best of at most `most` starts, and its problem.
fn best_start(
    problem: &Problem,
    free: &[usize],
    most: usize,
    observer: &mut dyn Observer,
) -> Option<(Fit, Problem)> {
    let mut best: Option<(Fit, Problem)> = None;
    for (courses, terms) in starts(problem, observer).into_iter().take(most) {
        let started = problem.with_hidden_courses(&courses, free);
        let settled = best.as_ref().filter(|(fit, _)| fit.converged);
        let beat = settled.map_or(f64::INFINITY, |(fit, _)| fit.value);
        let (support, coefficients) = terms.into_iter().unzip();
        let point = LinearizationPoint {
            support,
            coefficients,
            ..started.initial_point(&started.noise)
        };
        let rank = |fit: &Fit| (!fit.converged, fit.value);
        let better = |fit: &Fit| best.as_ref().is_none_or(|(old, _)| rank(fit) < rank(old));
        if let Some(fit) = tightened(&started, point, beat, observer).filter(better) {
            best = Some((fit, started));
        }
    }
    best
}

/// Proposed courses of hidden states, and columns with coefficients.
fn starts(problem: &Problem, observer: &mut dyn Observer) -> Vec<Start> {
    let (given, sought) = hidden_laws(problem);
    if sought.is_empty() {
        let terms = observed(problem, observer).into_iter().map(|o| o.terms);
        let along = terms.map(|terms| (Vec::new(), terms));
        if !problem.system.columns.is_empty() {
            return along.collect();
        }
        let run = hidden_courses_by_runs(problem).map(|courses| (courses, Vec::new()));
        let solved = solved_courses(problem, &given, observer);
        return along.chain(solved).chain(run).collect();
    }
    match solved_courses(problem, &sought, observer) {
        none if none.is_empty() => filtered_courses(problem, &sought, observer),
        solved => solved,
    }
}

/// The fit of the columns that a started problem proposes.
pub(crate) fn fit_proposed(problem: &Problem, observer: &mut dyn Observer) -> Option<Fit> {
    let (support, coefficients) = problem.proposed_columns()?.into_iter().unzip();
    let point = LinearizationPoint {
        support,
        coefficients,
        ..problem.initial_point(&problem.noise)
    };
    let criterion = final_criterion(problem);
    fit(problem, point, &criterion, f64::INFINITY, observer)
}

/// A fit from a distant point: the laws may slip more in the first fits than in the last (weak constraints before strong ones).
pub(super) fn tightened(
    problem: &Problem,
    mut point: LinearizationPoint,
    beat: f64,
    observer: &mut dyn Observer,
) -> Option<Fit> {
    let criterion = final_criterion(problem);
    let sigma = point.sigma.clone();
    for looseness in HIDDEN.looseness {
        let mut loose = problem.clone();
        loose.looseness = looseness;
        let found = fit(&loose, point, &criterion, f64::INFINITY, observer)?;
        point = LinearizationPoint {
            sigma: sigma.clone(),
            ..found.point
        };
    }
    fit(problem, point, &criterion, beat, observer)
}

impl Problem {
    /// The problem in which the hidden states start from their courses in a fit, one of them with an offset.
    pub(super) fn with_hidden_of(
        &self,
        fit: &Fit,
        free_scale: &[usize],
        offset: Option<&Offset>,
    ) -> Problem {
        let (given, sought) = hidden_laws(self);
        let course = |law: usize| {
            let by = offset.filter(|o| o.law == law).map_or(&[][..], |o| &o.by);
            let shift = |row: &[f64]| -> f64 {
                let at = |s: Signal| {
                    let place = self.system.states.iter().position(|x| *x == s);
                    place.and_then(|i| row.get(i)).copied().unwrap_or(0.0)
                };
                by.iter().map(|(term, c)| c * term.eval(&at)).sum()
            };
            HiddenCourse::along(self, law, fit.paths(), &shift)
        };
        let courses: Vec<HiddenCourse> = given.into_iter().chain(sought).map(course).collect();
        self.with_hidden_courses(&courses, free_scale)
    }
}
