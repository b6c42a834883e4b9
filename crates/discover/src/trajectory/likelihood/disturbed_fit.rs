//! Gauss–Newton for one support under process noise: coefficients and noises of the largest likelihood of the innovations.
//!
//! In: a problem, a point with process noise. Out: a [`Fit`] whose trajectory is the filtered one, or nothing where the laws diverge. About
//! every point the noises come first, with the laws linearised there; then coefficients and states move.

use super::criterion::{PenalizedLikelihood, residual_squares};
use super::fitted_support::{Fit, best_judged, is_hopeless, left_the_data};
use super::kalman_filter::{Filtered, Innovation};
use super::noise_estimation::estimate_noises;
use super::step_halving::{StepDecision, StepHalving};
use crate::trajectory::integration::{CompiledLaws, Diverged};
use crate::trajectory::least_squares::{IncrementalQr, NoRows, constrained_step};
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::thresholds::{DISTURBANCES, GAUSS_NEWTON};
use sidc_progress::Observer;

/// The criterion of a fit without process noise, computed from innovations so that it can be compared with fits with process noise. `None`
/// where the laws diverge or the observer ends the work.
pub(crate) fn undisturbed_value(
    problem: &Problem,
    fit: &Fit,
    criterion: &PenalizedLikelihood,
    observer: &mut dyn Observer,
) -> Option<f64> {
    let value = filtered(problem, fit, &mut |_| {}, observer).ok()?;
    Some(value - expected_square(problem) + criterion.cost(problem, fit.support()))
}

/// The expected χ² of the innovations, one for each reading: criteria of fits without process noise do not contain it, so it is subtracted.
fn expected_square(problem: &Problem) -> f64 {
    problem.measurements() as f64
}

/// The innovations of a fit, reading by reading. Empty where the laws diverge.
pub(crate) fn innovations(problem: &Problem, fit: &Fit) -> Vec<Innovation> {
    let mut all = Vec::new();
    let listener = &mut |i| all.push(i);
    match filtered(problem, fit, listener, &mut sidc_progress::Unwatched) {
        Ok(_) => all,
        Err(Diverged) => Vec::new(),
    }
}

/// Filters all records with the laws of a fit: −2 log likelihood of the innovations.
fn filtered(
    problem: &Problem,
    fit: &Fit,
    listener: &mut dyn FnMut(Innovation),
    observer: &mut dyn Observer,
) -> Result<f64, Diverged> {
    let code = CompiledLaws::new(&problem.system, fit.support());
    let sinks = (&mut NoRows(0), listener);
    problem.filter_parts((&code, None), &fit.point, &problem.whole(), sinks, observer)
}

/// Fits the support of `from`. Gives up early if the criterion is unlikely to come near `beat`. `None` where the laws diverge, the
/// trajectory leaves the data, or the observer ends the work.
pub(super) fn disturbed_fit(
    problem: &Problem,
    from: LinearizationPoint,
    criterion: &PenalizedLikelihood,
    beat: f64,
    observer: &mut dyn Observer,
) -> Option<Fit> {
    let code = CompiledLaws::new(&problem.system, &from.support);
    let cost = criterion.cost(problem, &from.support) - expected_square(problem);
    let rows = problem.system.constraints.on(&from.support);
    let mut point = from;
    let mut halving = StepHalving::default();
    halving.start_halving();
    let (mut converged, mut before) = (false, f64::INFINITY);
    // Noises are estimated in every other step and in the last; in the first only if no fit before has estimated them.
    let mut estimate = beat == f64::INFINITY;
    let mut known = false;
    for _ in 0..DISTURBANCES.max_steps {
        let Ok(intervals) = problem.intervals(&code, &point, observer) else {
            match halving.halfway(point).filter(|_| observer.go_on()) {
                Some(nearer) => point = nearer,
                None => return best_judged(halving).filter(|_| observer.go_on()),
            }
            continue;
        };
        let estimated = estimate;
        estimate = !estimate;
        if estimated {
            estimate_noises(problem, &intervals, &mut point);
        }
        known |= estimated;
        let mut qr = IncrementalQr::new(point.support.len());
        let Filtered { value, paths } = problem.filter(&intervals, &point, &mut qr);
        let constrained = constrained_step(&mut qr, &point.coefficients, &rows)?;
        let here = LinearizationPoint {
            paths,
            ..point.clone()
        };
        if left_the_data(problem, &here) {
            match halving.halfway(point) {
                Some(nearer) => point = nearer,
                None => return best_judged(halving),
            }
            continue;
        }
        let value = value + cost;
        let fit = Fit {
            residual_squares: residual_squares(problem, &here),
            point: here.clone(),
            variances: constrained.solution.variances,
            value,
            law_misfit: 0.0,
            converged: false,
        };
        let gain = qr.square_without_step() - constrained.solution.residual;
        let still = (before - value).abs() < GAUSS_NEWTON.criterion_step;
        match halving.judge(fit, value, &point) {
            StepDecision::Try(nearer) if !still => {
                point = nearer;
                continue;
            }
            StepDecision::End if !still => break,
            _ => {}
        }
        if gain < GAUSS_NEWTON.criterion_step && still && estimated {
            converged = true;
            break;
        }
        let gain = gain.max((before - value).abs());
        if known && is_hopeless(value - beat, DISTURBANCES.max_steps, gain) {
            break;
        }
        before = value;
        let farthest = farthest(problem, &point, &here);
        halving.starts(Some(point), farthest);
        point = LinearizationPoint {
            coefficients: constrained.coefficients,
            ..here
        };
    }
    let (fit, converged) = halving.best(converged)?;
    fit.value.is_finite().then_some(Fit { converged, ..fit })
}

/// The largest move of a state that is read, in units of its sensor's noise.
fn farthest(problem: &Problem, from: &LinearizationPoint, to: &LinearizationPoint) -> f64 {
    let n = problem.states();
    let mut farthest = 0.0f64;
    for (r, (a, b)) in from.paths.iter().zip(&to.paths).enumerate() {
        let own = problem.sensors.of(r);
        let (sigma, readings) = (&to.sigma[own.clone()], &problem.readings[own]);
        for (at, (a, b)) in a.iter().zip(b).enumerate() {
            if readings[at % n] > 0 {
                farthest = farthest.max(((a - b) / sigma[at % n]).abs());
            }
        }
    }
    farthest
}
