//! The noises of sensors and disturbances by maximum likelihood.
//!
//! In: a problem, its laws linearised along a trajectory. Out: the noises under which the innovations are most likely. Moves no coefficients.

use super::quasi_newton::minimise;
use crate::trajectory::integration::IntervalBlock;
use crate::trajectory::least_squares::NoRows;
use crate::trajectory::model::{Disturbance, LinearizationPoint, Problem, ProcessNoise};
use crate::trajectory::thresholds::{DISTURBANCES, SEARCH};

/// Sets the noises of a point to the most likely ones for its trajectory and coefficients.
pub(super) fn estimate_noises(
    problem: &Problem,
    intervals: &[IntervalBlock],
    point: &mut LinearizationPoint,
) {
    let bounds = bounds(problem, point);
    let start = noises(problem, point);
    let mut trial = point.clone();
    let mut value = |logs: &[f64]| {
        set_noises(problem, &mut trial, logs);
        let value = problem.filter(intervals, &trial, &mut NoRows(0)).value;
        if value.is_finite() {
            value
        } else {
            f64::INFINITY
        }
    };
    let readings = problem.measurements() as f64;
    let found = minimise(
        &mut value,
        start,
        &bounds,
        (readings, DISTURBANCES.converged),
    );
    if found.value.is_finite() {
        set_noises(problem, point, &found.at);
    }
}

impl Problem {
    /// Whether the readings show the noise of a sensor; that of an input is declared.
    fn shows_noise(&self, sensor: usize) -> bool {
        self.readings[sensor] > 0 && self.input_noise[sensor % self.states()].is_none()
    }
}

/// Logarithms of all noises that are estimated: of the sensors that read, then of the process.
fn noises(problem: &Problem, point: &LinearizationPoint) -> Vec<f64> {
    let sensors = (0..point.sigma.len()).filter(|i| problem.shows_noise(*i));
    let sensors = sensors.map(|i| point.sigma[i]);
    let process = point.process.iter().flat_map(ProcessNoise::values);
    sensors.chain(process).map(f64::ln).collect()
}

fn set_noises(problem: &Problem, point: &mut LinearizationPoint, logs: &[f64]) {
    let mut values = logs.iter().map(|x| x.exp());
    for (i, sigma) in point.sigma.iter_mut().enumerate() {
        if problem.shows_noise(i) {
            *sigma = values.next().unwrap_or(*sigma);
        }
    }
    if let Some(process) = &mut point.process {
        process.set_values(&mut values);
    }
}

/// Bounds of the logarithms: wide, so that they end at a bound only what the data do not determine.
fn bounds(problem: &Problem, point: &LinearizationPoint) -> Vec<(f64, f64)> {
    let n = problem.states();
    let floor = SEARCH.floors.iter().copied().fold(f64::INFINITY, f64::min);
    let [least, most] = DISTURBANCES.range;
    let mut all: Vec<(f64, f64)> = (0..point.sigma.len())
        .filter(|i| problem.shows_noise(*i))
        .map(|i| (floor * problem.spread[i % n], most * problem.spread[i % n]))
        .collect();
    let (step, length) = problem.step_and_length();
    let laws = point.process.iter().flat_map(|p| p.laws.iter().enumerate());
    for (l, disturbance) in laws {
        match disturbance {
            Disturbance::White { .. } => {
                let spread = problem.spread[problem.system.laws[l].state];
                all.push((least * spread / length.sqrt(), most * spread / step.sqrt()));
            }
            Disturbance::FirstOrder { .. } => {
                let spread = problem.rate_spread(l);
                all.push((least * spread, most * spread));
                all.push((0.5 * step, length));
            }
        }
    }
    all.into_iter().map(|(a, b)| (a.ln(), b.ln())).collect()
}
