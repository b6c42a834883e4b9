//! Gauss–Newton for one support: trajectory, coefficients and noise fitted together.
//!
//! In: a problem, a point to start from. Out: a [`Fit`], or nothing where the laws diverge. A step linearises, eliminates the states,
//! solves for the coefficients under their constraints and substitutes back; the noise of each sensor is then taken from its residuals.

use super::criterion::{PenalizedLikelihood, residual_squares};
use super::eliminated_records::EliminatedRecords;
use super::fitted_support::{Fit, best_judged, is_hopeless, left_the_data};
use super::step_halving::{StepDecision, StepHalving};
use crate::trajectory::integration::CompiledLaws;
use crate::trajectory::least_squares::{IncrementalQr, constrained_step};
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::thresholds::GAUSS_NEWTON;
use sidc_progress::Observer;

/// Fits the support of `from` from its coefficients, trajectory and noise. Gives up early if the criterion is unlikely to come near
/// `beat`. `None` where the laws diverge, the trajectory leaves the data, or the observer ends the work.
pub(super) fn undisturbed_fit(
    problem: &Problem,
    from: LinearizationPoint,
    criterion: &PenalizedLikelihood,
    beat: f64,
    observer: &mut dyn Observer,
) -> Option<Fit> {
    let code = CompiledLaws::new(&problem.system, &from.support);
    let k = from.support.len();
    let cost = criterion.cost(problem, &from.support);
    let rows = problem.system.constraints.on(&from.support);
    let mut point = from;
    let (mut before, mut value) = (f64::INFINITY, f64::INFINITY);
    let mut found = None;
    let mut halving = StepHalving::default();
    let mut left = GAUSS_NEWTON.max_steps;
    if code.switches.is_some() {
        left += GAUSS_NEWTON.event_steps;
    }
    while left > 0 {
        left -= 1;
        let mut qr = IncrementalQr::new(k);
        let Ok(eliminated) = EliminatedRecords::new((problem, &code), &point, &mut qr, observer)
        else {
            match halving.halfway(point).filter(|_| observer.go_on()) {
                Some(nearer) => point = nearer,
                None => return best_judged(halving).filter(|_| observer.go_on()),
            }
            continue;
        };
        let constrained = constrained_step(&mut qr, &point.coefficients, &rows)?;
        let solved = constrained.solution;
        if halving.is_halving() {
            left += usize::from(halving.may_add_step());
            let none = vec![0.0; k];
            let moves = eliminated.states(&none, observer).ok()?;
            let here = (moves, qr.square_without_step(), &solved.variances[..]);
            let here = fit_here(problem, criterion, &point, here);
            if left_the_data(problem, &here.point) {
                match halving.halfway(point) {
                    Some(nearer) => point = nearer,
                    None => return best_judged(halving),
                }
                continue;
            }
            let value = here.value;
            match halving.judge(here, value, &point) {
                StepDecision::Step => {}
                StepDecision::Try(nearer) => {
                    point = nearer;
                    continue;
                }
                StepDecision::End => break,
            }
        }
        let moves = eliminated.states(&solved.coefficients, observer).ok()?;
        let start = halving.is_halving().then(|| point.clone());
        let farthest = move_states(problem, &mut point, &moves);
        point.coefficients = constrained.coefficients;
        halving.starts(start, farthest);
        if !farthest.is_finite() || left_the_data(problem, &point) {
            match halving.halfway(point) {
                Some(nearer) => point = nearer,
                None => return best_judged(halving),
            }
            continue;
        }
        let (residual_squares, law_misfit) = misfits(problem, &point, solved.residual);
        let new = criterion.deviance(problem, &residual_squares) + law_misfit + cost;
        let sigma: Vec<f64> = (0..residual_squares.len())
            .map(|i| criterion.noise(problem, &residual_squares, i, &point.sigma))
            .collect();
        let moved = sigma
            .iter()
            .zip(&point.sigma)
            .map(|(a, b)| (a / b).ln().abs());
        let moved = moved.fold(0.0, f64::max);
        point.sigma = sigma;
        let still = farthest < GAUSS_NEWTON.state_step
            && moved < GAUSS_NEWTON.log_noise_step
            && are_still(&solved.coefficients, &solved.variances);
        let level = match halving.is_halving() {
            true => halving.gain_is_negligible(new),
            false => (new - value).abs() < GAUSS_NEWTON.criterion_step,
        };
        let hopeless = is_hopeless(new - beat, left, (value - new).abs());
        // An event that changes its interval at every step leads to and fro between two points.
        let cycles = !level && (new - before).abs() < GAUSS_NEWTON.criterion_step;
        if new > value + GAUSS_NEWTON.uphill || cycles {
            halving.start_halving();
        }
        (before, value) = (value, new);
        let converged = still || level;
        found = Some((solved.variances, residual_squares, law_misfit, converged));
        if converged || hopeless {
            break;
        }
    }
    if halving.has_judged() {
        let converged = found.is_some_and(|(.., converged)| converged);
        let (fit, converged) = halving.best(converged)?;
        return fit.value.is_finite().then_some(Fit { converged, ..fit });
    }
    let (variances, residual_squares, law_misfit, converged) = found?;
    value.is_finite().then_some(Fit {
        point,
        variances,
        value,
        residual_squares,
        law_misfit,
        converged,
    })
}

/// Moves the trajectories; the largest move of a state that is read, in units of its sensor's noise.
fn move_states(problem: &Problem, point: &mut LinearizationPoint, moves: &[Vec<f64>]) -> f64 {
    let n = problem.states();
    let mut farthest = 0.0f64;
    for (r, (path, moves)) in point.paths.iter_mut().zip(moves).enumerate() {
        let (own, readable) = (problem.sensors.of(r), &problem.records[r]);
        let (sigma, readings) = (&point.sigma[own.clone()], &problem.readings[own]);
        for (at, (x, d)) in path.iter_mut().zip(moves).enumerate() {
            *x += d;
            let i = at % n;
            if readings[i] > 0 {
                let sigma = sigma[i] * readable.relative_noise_at(i, at / n);
                farthest = farthest.max((d / sigma).abs());
            }
        }
    }
    farthest
}

/// Whether these steps of the coefficients change the criterion by too little to matter: a step of t standard errors changes it by t². A
/// start may have every measured state in its place and the coefficients far from theirs.
fn are_still(steps: &[f64], variances: &[f64]) -> bool {
    let mut steps = steps.iter().zip(variances);
    steps.all(|(step, variance)| step.powi(2) <= GAUSS_NEWTON.criterion_step * variance)
}

/// The fit at a point with the coefficients that it has: only the states follow the laws there.
fn fit_here(
    problem: &Problem,
    criterion: &PenalizedLikelihood,
    at: &LinearizationPoint,
    (moves, square, variances): (Vec<Vec<f64>>, f64, &[f64]),
) -> Fit {
    let mut point = at.clone();
    for (path, moves) in point.paths.iter_mut().zip(moves) {
        path.iter_mut().zip(moves).for_each(|(x, d)| *x += d);
    }
    let (residual_squares, law_misfit) = misfits(problem, &point, square);
    let value = criterion.deviance(problem, &residual_squares)
        + law_misfit
        + criterion.cost(problem, &point.support);
    Fit {
        point,
        variances: variances.to_vec(),
        value,
        residual_squares,
        law_misfit,
        converged: false,
    }
}

/// The squared residuals of each sensor, and what they leave of the χ² `square` of all rows: that of the slips.
fn misfits(problem: &Problem, at: &LinearizationPoint, square: f64) -> (Vec<f64>, f64) {
    let squares = residual_squares(problem, at);
    let explained = squares.iter().zip(&at.sigma);
    let explained: f64 = explained.map(|(square, s)| square / s.powi(2)).sum();
    (squares, (square - explained).max(0.0))
}
