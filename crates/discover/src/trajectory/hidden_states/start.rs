//! The start from which all laws are fitted best.
//!
//! In: a problem with hidden states, values of its constants. Out: the same problem with courses and columns to start from. Proposes none itself.

use super::filtered_course::filtered_courses;
use super::given_course::given_courses;
use super::hidden_laws::hidden_laws;
use super::observed_fit::observed;
use super::scale::is_free;
use super::thresholds::HIDDEN;
use crate::trajectory::likelihood::{Fit, fit};
use crate::trajectory::model::{HiddenCourse, LinearizationPoint, Problem};
use crate::trajectory::search::final_criterion;
use sidc_progress::Observer;

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
