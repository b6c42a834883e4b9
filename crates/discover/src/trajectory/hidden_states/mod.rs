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

pub(crate) use constant_values::likely_constants;
pub(crate) use scale::with_told_scales;
pub use scale::ToldScale;

use crate::trajectory::likelihood::{Fit, fit};
use crate::trajectory::model::{HiddenCourse, LinearizationPoint, Problem};
use crate::trajectory::search::final_criterion;
use filtered_course::filtered_courses;
use given_course::given_courses;
use observed_fit::{ObservedFit, observed_fits};
use scale::is_free;
use sidc_progress::Observer;

/// The hidden laws of a problem: those that are given, and those with columns.
fn hidden_laws(problem: &Problem) -> (Vec<usize>, Vec<usize>) {
    let laws = problem.system.laws.iter().enumerate();
    let hidden = laws.filter(|(_, law)| problem.system.is_hidden(law.state));
    let (given, sought): (Vec<_>, Vec<_>) = hidden.partition(|(_, law)| law.columns.is_empty());
    let place = |laws: Vec<(usize, _)>| laws.into_iter().map(|(l, _)| l).collect();
    (place(given), place(sought))
}

/// The problem with a start for its hidden states, and for the columns.
pub(crate) fn with_started_states(problem: &Problem, observer: &mut dyn Observer) -> Problem {
    let (given, sought) = hidden_laws(problem);
    let mut problem = problem.clone();
    if let Some(courses) = given_courses(&problem, &given).filter(|c| !c.is_empty()) {
        problem = problem.with_hidden_courses(&courses, &[]);
    }
    if sought.is_empty() {
        problem.proposed = observed(&problem, observer).map(|(_, terms)| terms);
        return problem;
    }
    let free: Vec<usize> = sought.iter().copied().filter(|l| is_free(&problem, *l)).collect();
    let criterion = final_criterion(&problem);
    let mut best: Option<(f64, Problem)> = None;
    for found in filtered_courses(&problem, &sought, observer) {
        let mut started = problem.with_hidden_courses(&found.courses, &free);
        let beat = best.as_ref().map_or(f64::INFINITY, |b| b.0);
        let (support, coefficients) = found.terms.iter().copied().unzip();
        let point = LinearizationPoint {
            support,
            coefficients,
            ..started.initial_point(&started.noise)
        };
        let fitted = fit(&started, point, &criterion, beat, observer).filter(|f| f.arrived);
        debug(&format!("{:?} {:?}", fitted.as_ref().map(|f| (f.value, f.arrived, f.point.active())), found.terms));
        if let Some(fitted) = fitted.filter(|f| f.value < beat) {
            started = started.with_hidden_of(&fitted, &free);
            started.proposed = Some(fitted.point.active());
            best = Some((fitted.value, started));
        }
    }
    best.map_or(problem, |(_, started)| started)
}

impl Problem {
    /// The problem whose hidden states start from where they are in a fit.
    fn with_hidden_of(&self, fit: &Fit, free_scale: &[usize]) -> Problem {
        let n = self.states();
        let (_, sought) = hidden_laws(self);
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
        let courses: Vec<HiddenCourse> = sought.into_iter().map(course).collect();
        self.with_hidden_courses(&courses, free_scale)
    }
}

/// The criterion of the measured part with the hidden states as they are, and its columns.
fn observed(problem: &Problem, observer: &mut dyn Observer) -> Option<(f64, Vec<(usize, f64)>)> {
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
    let fits = observed_fits(&part.problem, observer).into_iter();
    let best = fits.min_by(|a, b| a.value.total_cmp(&b.value));
    let ObservedFit { value, terms, .. } = best?;
    let whole = |(j, a): (usize, f64)| Some((part.origin[j]?, a));
    Some((value, terms.into_iter().filter_map(whole).collect()))
}
pub(crate) fn debug(text: &str) { if std::env::var("SIDC_DEBUG").is_ok() { eprintln!("{text}"); } }
