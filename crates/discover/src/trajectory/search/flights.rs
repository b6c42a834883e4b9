//! Unknown constants of jumps, from the flights between them.
//!
//! In: a problem whose states jump, constants near the right ones. Out: likelier values, with the terms of the laws. Between two jumps the laws hold
//! without them: they are fitted to the flights, each a record of its own. The constants are those with which the laws lead from the last state
//! of a flight to the first of the next. While constants are wrong, a fit of whole records would move every later jump off its place.

use super::least_squares_of_constants::{least_squares_of_constants, with_values};
use super::support_search::initial_fit;
use super::unknown_constants::{
    FittedConstants, SoughtConstant, fit_constants_at, with_constant_values,
};
use crate::trajectory::integration::{CompiledLaws, IntervalBlock, ShootingIntegrator, Workspace};
use crate::trajectory::likelihood::{PenalizedLikelihood, fit};
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::thresholds::{AHEAD, SEARCH};
use sidc_progress::Observer;

/// The likeliest constants of jumps, with the terms that the flights between them show.
pub fn fit_constants_of_jumps(
    problem: &Problem,
    constants: &[SoughtConstant],
    observer: &mut dyn Observer,
) -> Option<FittedConstants> {
    let (near, point) = constants_between_flights(problem, constants, observer)?;
    let fitted = fit_constants_at(problem, point.clone(), &near, 1.0, observer);
    // Terms that are nearly right may not lead along whole records; the constants are a start all the same.
    fitted.or_else(|| {
        Some(FittedConstants {
            value: f64::MAX,
            standard_errors: vec![f64::INFINITY; near.len()],
            terms: point.active(),
            variances: vec![f64::INFINITY; point.support.len()],
            constants: near,
        })
    })
}

/// The problem with what fits the flights as its smoothed trajectories, and the terms found there to start from. The same problem where nothing
/// can be fitted.
pub fn with_flown_states(problem: &Problem, observer: &mut dyn Observer) -> Problem {
    let mut flown = problem.clone();
    if let Some(point) = fitted_flights(problem, observer) {
        flown.proposed = Some(point.active());
        for (curve, path) in flown.smoothed.iter_mut().zip(point.paths) {
            curve.states = path;
        }
    }
    flown
}

/// A point of the whole problem that fits the flights. `None` where nothing can be fitted to them.
fn fitted_flights(problem: &Problem, observer: &mut dyn Observer) -> Option<LinearizationPoint> {
    let flights = problem.flights();
    let mut point = match flights.system.columns.is_empty() {
        true => flights.initial_point(&flights.noise),
        false => initial_fit(&flights, observer)?.point,
    };
    for floor in SEARCH.floors {
        let criterion = PenalizedLikelihood::at_floor(&flights, floor, 1.0);
        let from = LinearizationPoint {
            sigma: criterion.above_floor(&flights.noise),
            ..point.clone()
        };
        if let Some(found) = fit(&flights, from, &criterion, f64::INFINITY, observer) {
            point = found.point;
        }
    }
    let (n, mut flown) = (
        problem.states(),
        std::mem::take(&mut point.paths).into_iter(),
    );
    for (record, curve) in problem.records.iter().zip(&problem.smoothed) {
        let mut path = curve.states.clone();
        let flights = curve.flights(record.len()).into_iter();
        for (samples, own) in flights.zip(flown.by_ref()) {
            path[samples.start * n..samples.end * n].copy_from_slice(&own);
        }
        point.paths.push(path);
    }
    point.sigma.clone_from(&problem.noise);
    Some(point)
}

/// The constants and a point of the whole problem. `None` where nothing can be fitted to the flights.
fn constants_between_flights(
    problem: &Problem,
    constants: &[SoughtConstant],
    observer: &mut dyn Observer,
) -> Option<(Vec<SoughtConstant>, LinearizationPoint)> {
    let point = fitted_flights(problem, observer)?;
    let laws = CompiledLaws::new(&problem.system, &point.support);
    let missed = |values: &[f64]| {
        let problem = with_constant_values(problem, &with_values(constants, values));
        missed_starts(&problem, &laws, &point)
    };
    let moved = least_squares_of_constants(constants, &missed)?;
    Some((moved, point))
}

/// What the laws, across the jumps, miss the first states of flights by, in units of their spread. `None` where they diverge.
fn missed_starts(
    problem: &Problem,
    laws: &CompiledLaws,
    point: &LinearizationPoint,
) -> Option<Vec<f64>> {
    let integrator = ShootingIntegrator {
        laws,
        all: None,
        coefficients: &point.coefficients,
        spread: &problem.spread,
        accuracy: AHEAD.accuracy,
    };
    let (n, mut work) = (problem.states(), Workspace::default());
    let mut missed = Vec::new();
    let records = problem.records.iter().zip(&point.paths);
    for ((record, path), curve) in records.zip(&problem.smoothed) {
        for row in &curve.jumps {
            let mut block = IntervalBlock::default();
            let passed = integrator.block(record, path, row - 1..*row, &mut work, &mut block);
            passed.ok()?;
            let next = &path[row * n..(row + 1) * n];
            let pairs = block.end.iter().zip(next).zip(&problem.spread);
            missed.extend(pairs.map(|((end, next), spread)| (end - next) / spread));
        }
    }
    Some(missed)
}
