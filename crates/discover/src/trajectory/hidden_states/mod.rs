//! Where the search starts that has states which nothing measures.
//!
//! In: a problem with hidden states, values of its constants. Out: the same problem with a course of each hidden state and columns to start from;
//! values of constants from which laws that are given lead along the readings. Estimates nothing exactly: the search does.

mod constant_values;
mod filtered_course;
mod given_course;
mod observed_fit;
mod scale;
pub(crate) mod thresholds;
mod twins;

pub(crate) use constant_values::likely_constants;
pub use scale::ToldScale;
pub(crate) use scale::with_told_scales;
pub(crate) use twins::exchanged_lags;

use crate::trajectory::likelihood::{Fit, fit};
use crate::trajectory::model::{HiddenCourse, LinearizationPoint, Problem};
use crate::trajectory::search::final_criterion;
use filtered_course::filtered_courses;
use given_course::given_courses;
use observed_fit::{ObservedFit, observed_fits};
use scale::is_free;
use sidc_progress::Observer;
use thresholds::HIDDEN;

/// The hidden laws of a problem: those that are given, and those with columns.
fn hidden_laws(problem: &Problem) -> (Vec<usize>, Vec<usize>) {
    let laws = problem.system.laws.iter().enumerate();
    let hidden = laws.filter(|(_, law)| problem.system.is_hidden(law.state));
    let (given, sought): (Vec<_>, Vec<_>) = hidden.partition(|(_, law)| law.columns.is_empty());
    let place = |laws: Vec<(usize, _)>| laws.into_iter().map(|(l, _)| l).collect();
    (place(given), place(sought))
}

/// The problem with a start for its hidden states, and for the columns: of all that are proposed the one from which a fit of all laws is best.
/// Fits that do not settle count where there is no other: with nothing to hold a hidden state they may run off.
pub(crate) fn with_started_states(problem: &Problem, observer: &mut dyn Observer) -> Problem {
    let (given, sought) = hidden_laws(problem);
    let mut problem = problem.clone();
    if let Some(courses) = given_courses(&problem, &given).filter(|c| !c.is_empty()) {
        problem = problem.with_hidden_courses(&courses, &[]);
    }
    let free: Vec<usize> = (sought.iter().copied())
        .filter(|l| is_free(&problem, *l))
        .collect();
    let starts = match sought.is_empty() {
        true => {
            let terms = observed(&problem, observer).into_iter().map(|o| o.terms);
            terms.map(|terms| (Vec::new(), terms)).collect()
        }
        false => filtered_courses(&problem, &sought, observer),
    };
    let mut best: Option<(Fit, Problem)> = None;
    for (courses, terms) in starts {
        let started = problem.with_hidden_courses(&courses, &free);
        let settled = best.as_ref().filter(|(fit, _)| fit.arrived);
        let beat = settled.map_or(f64::INFINITY, |(fit, _)| fit.value);
        let (support, coefficients) = terms.into_iter().unzip();
        let point = LinearizationPoint {
            support,
            coefficients,
            ..started.initial_point(&started.noise)
        };
        let rank = |fit: &Fit| (!fit.arrived, fit.value);
        let better = |fit: &Fit| best.as_ref().is_none_or(|(old, _)| rank(fit) < rank(old));
        if let Some(fit) = tightened(&started, point, beat, observer).filter(better) {
            best = Some((fit, started));
        }
    }
    let Some((fit, started)) = best else {
        return problem;
    };
    let mut started = started.with_hidden_of(&fit, &free);
    started.proposed = Some(fit.point.active());
    started
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

/// A fit from a point far off: of laws that may slip first, then of tighter ones (weak constraints before strong ones).
fn tightened(
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
    /// The problem whose hidden states start from where they are in a fit.
    fn with_hidden_of(&self, fit: &Fit, free_scale: &[usize]) -> Problem {
        let n = self.states();
        let (given, sought) = hidden_laws(self);
        let course = |law: usize| {
            let own = &self.system.laws[law];
            let first = own.state + 1 - usize::from(own.target.der);
            let chain = |path: &Vec<f64>| {
                let along = |i: usize| path.iter().skip(i).step_by(n).copied().collect();
                (first..=own.state).map(along).collect()
            };
            HiddenCourse {
                law,
                records: fit.paths().iter().map(chain).collect(),
            }
        };
        let courses: Vec<HiddenCourse> = given.into_iter().chain(sought).map(course).collect();
        self.with_hidden_courses(&courses, free_scale)
    }
}

/// The fits of the measured part with the hidden states as they are, in columns of the whole problem.
fn observed(problem: &Problem, observer: &mut dyn Observer) -> Vec<ObservedFit> {
    let system = &problem.system;
    let columns = |law: usize| {
        let own = system.laws[law].columns.clone();
        own.map(|j| (Some(j), system.columns[j].clone())).collect()
    };
    let mut part = problem.observed_part(&columns);
    let n = problem.states();
    for (i, signal) in system.states.iter().enumerate() {
        if system.is_hidden(i) {
            let values: Vec<Vec<f64>> = (problem.smoothed.iter())
                .map(|c| c.states.iter().skip(i).step_by(n).copied().collect())
                .collect();
            part.problem
                .set_exogenous(*signal, false, values.iter().map(Vec::as_slice));
        }
    }
    let whole = |(j, a): (usize, f64)| Some((part.origin[j]?, a));
    let fits = observed_fits(&part.problem, observer).into_iter();
    fits.map(|fit| ObservedFit {
        terms: fit.terms.into_iter().filter_map(whole).collect(),
        ..fit
    })
    .collect()
}
