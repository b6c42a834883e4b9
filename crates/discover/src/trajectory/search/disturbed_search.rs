//! The search of laws that are disturbed: support, coefficients and disturbances together.
//!
//! In: a problem, the best fit without disturbances. Out: the problem with process noise and the best fit to it, or nothing where laws
//! without disturbances explain the readings as well. Disturbances are white, or remember as an autoregression of first order does;
//! the criterion decides, in which every number that describes them costs as a parameter (Schwarz 1978).

use super::noise_floor_search::{NoiseFloorSearch, at_minimum};
use super::search_observer::SearchObserver;
use super::support_search::{Found, Rival, final_criterion, rivals_among};
use crate::trajectory::likelihood::{Fit, fit, undisturbed_value};
use crate::trajectory::model::{LinearizationPoint, Problem, ProcessNoise};
use crate::trajectory::thresholds::{DISTURBANCES, SEARCH};

/// Searches from the support of the best fit without disturbances, if there is one. `gained`: by how much another explanation improves the
/// criterion of that fit; disturbances must improve it by more. Returns the problem whose states include disturbances with a memory, and
/// the fit to it. `None` if the fit without disturbances is as good, or nothing could be fitted.
///
/// Long records are searched on segments first.
pub fn search_disturbed(
    problem: &Problem,
    (free, gained): (Option<&Fit>, f64),
    observer: &mut dyn SearchObserver,
) -> Option<(Problem, Found)> {
    let criterion = final_criterion(problem);
    let value = |fit| undisturbed_value(problem, fit, &criterion, observer);
    // Declared input noise is not optional, so a fit without it is no alternative.
    let comparable = free.filter(|_| problem.process.is_none());
    let without = comparable.and_then(value).unwrap_or(f64::INFINITY) - gained;
    // Disturbances with a memory are not tried beside noisy inputs or hidden states, since they are hidden states too.
    let white = problem.process.is_some() || !problem.system.hidden.is_empty();
    let kinds: &[Kind] = match white {
        true => &[Kind::White],
        false => &[Kind::White, Kind::FirstOrder],
    };
    let short = problem.on_segments();
    let searched = short.as_ref().unwrap_or(problem);
    let readings = searched.measurements() as f64;
    let price = |kind: Kind| (kind.numbers() * problem.system.laws.len()) as f64;
    let mut best: Option<(f64, Kind, Problem, Found)> = None;
    for kind in kinds.iter().copied() {
        let (disturbed, point) = start(searched, kind, free);
        let Some(found) = search_from(&disturbed, point, observer) else {
            continue;
        };
        let value = found.best.value + price(kind) * readings.ln();
        if best.as_ref().is_none_or(|b| value < b.0) {
            best = Some((value, kind, disturbed, found));
        }
    }
    let (_, kind, disturbed, found) = best?;
    let (disturbed, found) = match short {
        None => (disturbed, found),
        // Disturbances that leave more than noise on segments do so on all samples, too.
        Some(_) if observer.left_by(&disturbed, &found.best) > 1.0 => return None,
        Some(_) => on_whole((problem, kind), found, free, observer)?,
    };
    let paid = price(kind) * (problem.measurements() as f64).ln();
    (found.best.value + paid < without).then_some((disturbed, found))
}

/// A problem with disturbances of this kind, and where its search starts.
fn start(problem: &Problem, kind: Kind, free: Option<&Fit>) -> (Problem, LinearizationPoint) {
    let smooth = problem.initial_point(&problem.noise);
    let (disturbed, point) = kind.of(problem, &smooth);
    let (support, coefficients) = free
        .map(|fit| (fit.support().to_vec(), fit.coefficients().to_vec()))
        .unwrap_or_default();
    let point = LinearizationPoint {
        support,
        coefficients,
        ..point
    };
    (disturbed, point)
}

/// The support found on segments, fitted to all samples.
fn on_whole(
    (problem, kind): (&Problem, Kind),
    found: Found,
    free: Option<&Fit>,
    observer: &mut dyn SearchObserver,
) -> Option<(Problem, Found)> {
    let (whole, point) = start(problem, kind, free);
    let point = LinearizationPoint {
        support: found.best.point.support.clone(),
        coefficients: found.best.point.coefficients.clone(),
        process: found.best.point.process.clone(),
        sigma: found.best.point.sigma.clone(),
        ..point
    };
    let criterion = final_criterion(&whole);
    let best = fit(&whole, point, &criterion, f64::INFINITY, observer)?;
    let rivals = vec![Rival::new(best.support().to_vec(), best.value)];
    let found = Found {
        best,
        rivals,
        ..found
    };
    Some((whole, found))
}

#[derive(Clone, Copy)]
enum Kind {
    White,
    FirstOrder,
}

impl Kind {
    /// Numbers that describe the disturbance of a law.
    fn numbers(self) -> usize {
        match self {
            Kind::White => 1,
            Kind::FirstOrder => 2,
        }
    }

    /// A problem with disturbances of this kind, and a point of it. They start as large as what the laws explain.
    fn of(self, problem: &Problem, at: &LinearizationPoint) -> (Problem, LinearizationPoint) {
        let (step, _) = problem.step_and_length();
        match self {
            Kind::White => {
                let size = |l| DISTURBANCES.first_size * problem.rate_spread(l) * step.sqrt();
                let inputs = problem.process.as_ref().map(|p| p.inputs.clone());
                let process = ProcessNoise {
                    inputs: inputs.unwrap_or_default(),
                    ..ProcessNoise::white(&problem.system, size)
                };
                let mut problem = problem.clone();
                problem.process = Some(process.clone());
                let point = LinearizationPoint {
                    process: Some(process),
                    ..at.clone()
                };
                (problem, point)
            }
            Kind::FirstOrder => problem.with_disturbance_states(at, |l| {
                let size = DISTURBANCES.first_size * problem.rate_spread(l);
                (size, DISTURBANCES.first_memory * step)
            }),
        }
    }
}

/// The best support under disturbances, from two kinds of starts: the one given, and supports proposed about a fit of disturbances alone.
fn search_from(
    problem: &Problem,
    start: LinearizationPoint,
    observer: &mut dyn SearchObserver,
) -> Option<Found> {
    let criterion = final_criterion(problem);
    let penalty = criterion.penalty;
    let mut level = NoiseFloorSearch::new(problem, criterion);
    let mut starts = proposals(problem, &start, penalty, observer);
    starts.insert(0, start);
    level.fit(starts, observer);
    // Disturbances count only if they leave no more than noise, and that hardly changes from one support to the next. So supports are
    // compared further only where the residuals are near the noise.
    if left_by(problem, &level, observer) <= DISTURBANCES.hopeless {
        level.improve((false, false), observer);
        if left_by(problem, &level, observer) <= 1.0 {
            level.improve((true, true), observer);
        }
    }
    let tried = level.tried.len();
    Some(Found {
        best: level.best.into_iter().next()?,
        rivals: rivals_among(level.tried),
        tried,
        penalty,
        inefficiency: 1.0,
    })
}

/// Residuals of the best fit over what noise alone may give.
fn left_by(problem: &Problem, level: &NoiseFloorSearch, observer: &mut dyn SearchObserver) -> f64 {
    let best = level.best.first();
    best.map_or(f64::INFINITY, |fit| observer.left_by(problem, fit))
}

/// Supports proposed on the likelihood linearised about a fit of disturbances without any terms.
fn proposals(
    problem: &Problem,
    start: &LinearizationPoint,
    penalty: f64,
    observer: &mut dyn SearchObserver,
) -> Vec<LinearizationPoint> {
    let alone = LinearizationPoint {
        support: Vec::new(),
        coefficients: Vec::new(),
        ..start.clone()
    };
    let criterion = final_criterion(problem);
    let alone: Option<Fit> = fit(problem, alone, &criterion, f64::INFINITY, observer);
    let Some(alone) = alone else {
        return Vec::new();
    };
    let Ok(form) = problem.quadratic_form(&alone.point, observer) else {
        return Vec::new();
    };
    let prices = SEARCH.initial_prices.map(|p| p * penalty);
    let supports = form.backward_elimination(&prices).into_iter();
    let supports = supports.map(|s| form.steepest_descent(&s, penalty));
    supports
        .map(|s| at_minimum(problem, &form, &alone.point, s))
        .collect()
}
