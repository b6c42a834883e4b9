//! Prediction errors of laws without their disturbances, some time ahead of given states.
//!
//! In: problems of the same records, their laws, states to start from. Out: errors of every state that is read. Fits nothing.

use crate::trajectory::integration::{
    CompiledLaws, Diverged, INTERVALS_AT_ONCE, IntervalBlock, ShootingIntegrator, Workspace,
};
use crate::trajectory::likelihood::Fit;
use crate::trajectory::model::{Law, LinearizationPoint, Problem, Record};
use crate::trajectory::thresholds::AHEAD;

/// How far ahead predictions are compared (s): a few times the time in which the slowest state moves by its spread. Beyond that, disturbed
/// motion is hardly predicted better than by its mean.
pub fn own_time(problem: &Problem) -> f64 {
    let laws = problem.system.laws.iter().enumerate();
    let of = |(l, law): (usize, &Law)| problem.spread[law.state] / problem.rate_spread(l);
    AHEAD.own_times * laws.map(of).fold(0.0, f64::max)
}

/// The mean logarithm of the prediction errors `ahead` seconds after each start, over the states that are read; disturbances are left out.
/// Starts are the states `from`, the first ones of the problem's states. Infinite where a run diverges or no record is long enough.
pub fn log_error_ahead(problem: &Problem, fit: &Fit, from: &[Vec<f64>], ahead: f64) -> f64 {
    let (step, _) = problem.step_and_length();
    let steps = (ahead / step).round().max(1.0) as usize;
    let code = CompiledLaws::new(&problem.system, fit.support());
    let mut squares = vec![0.0; problem.states()];
    let mut count = 0;
    for (r, record) in problem.records.iter().enumerate() {
        let Some(room) = record.len().checked_sub(steps + INTERVALS_AT_ONCE + 1) else {
            continue;
        };
        let blocks = AHEAD.blocks.min(room / INTERVALS_AT_ONCE + 1);
        for b in 0..blocks {
            let start = room * b / (blocks - 1).max(1);
            let Ok(errors) = block_errors(
                (problem, &code),
                &fit.point,
                record,
                &from[r],
                (start, steps),
            ) else {
                return f64::INFINITY;
            };
            squares.iter_mut().zip(&errors).for_each(|(s, e)| *s += e);
            count += 1;
        }
    }
    let logs: Vec<f64> = problem
        .read_states()
        .map(|i| 0.5 * squares[i].ln())
        .collect();
    match count {
        0 => f64::INFINITY,
        _ => logs.iter().sum::<f64>() / logs.len() as f64,
    }
}

/// Squared prediction errors of runs from as many neighbouring samples as are integrated at once.
fn block_errors(
    (problem, laws): (&Problem, &CompiledLaws),
    at: &LinearizationPoint,
    record: &Record,
    from: &[f64],
    (start, steps): (usize, usize),
) -> Result<Vec<f64>, Diverged> {
    let n = problem.states();
    let given = from.len() / record.len();
    let integrator = ShootingIntegrator {
        laws,
        all: None,
        coefficients: &at.coefficients,
        spread: &problem.spread,
        accuracy: AHEAD.accuracy,
    };
    let (mut work, mut block) = (Workspace::default(), IntervalBlock::default());
    let mut states = vec![0.0; record.len() * n];
    for k in start..start + INTERVALS_AT_ONCE {
        let known = given.min(n);
        states[k * n..k * n + known].copy_from_slice(&from[k * given..k * given + known]);
        // Laws are run without their disturbances.
        for (state, mean, _) in at.process.iter().flat_map(|p| p.stationary()) {
            states[k * n + state] = mean;
        }
    }
    for step in 0..steps {
        let here = start + step;
        let intervals = here..here + INTERVALS_AT_ONCE;
        integrator.block(record, &states, intervals, &mut work, &mut block)?;
        states[(here + 1) * n..(here + 1 + INTERVALS_AT_ONCE) * n]
            .copy_from_slice(&block.end[..INTERVALS_AT_ONCE * n]);
    }
    let mut squares = vec![0.0; n];
    for k in start + steps..start + steps + INTERVALS_AT_ONCE {
        for (i, square) in squares.iter_mut().enumerate() {
            let read = record.measured[i][k];
            if read.is_finite() {
                *square += (read - states[k * n + i]).powi(2);
            }
        }
    }
    match squares.iter().all(|s| s.is_finite()) {
        true => Ok(squares),
        false => Err(Diverged),
    }
}
