//! Smoothed trajectories: where estimation starts.
//!
//! In: records. Out: a [`SmoothedTrajectory`] each, with the noise that smoothing shows. States without readings are differentiated from
//! lower derivatives or integrated from higher ones.

use std::ops::Range;

use super::jump_rows::jump_rows;
use super::record::Record;
use super::system::System;
use sidc_data as data;
use sidc_lang::sensor_noise::SensorNoise;

/// A first guess of a trajectory.
#[derive(Clone, Debug, Default)]
pub(crate) struct SmoothedTrajectory {
    /// Samples × n.
    pub states: Vec<f64>,
    /// Samples × laws.
    pub rates: Vec<f64>,
    /// Standard deviation of each state's noise; `None` where it is not measured.
    pub noise: Vec<Option<f64>>,
    /// Samples between which and the one before states jump, rising.
    pub jumps: Vec<usize>,
}

impl SmoothedTrajectory {
    pub fn at(&self, k: usize, n: usize) -> &[f64] {
        &self.states[k * n..(k + 1) * n]
    }

    /// Some of its samples, for n states and m laws.
    pub fn part(&self, samples: Range<usize>, n: usize, m: usize) -> SmoothedTrajectory {
        SmoothedTrajectory {
            states: self.states[samples.start * n..samples.end * n].to_vec(),
            rates: self.rates[samples.start * m..samples.end * m].to_vec(),
            noise: self.noise.clone(),
            jumps: (self.jumps.iter())
                .filter(|row| samples.contains(row) && **row > samples.start)
                .map(|row| row - samples.start)
                .collect(),
        }
    }

    /// The samples between jumps.
    pub fn flights(&self, length: usize) -> Vec<Range<usize>> {
        let starts = [0].into_iter().chain(self.jumps.iter().copied());
        let ends = self.jumps.iter().copied().chain([length]);
        starts.zip(ends).map(|(from, to)| from..to).collect()
    }

    pub fn rate_at(&self, k: usize, m: usize) -> &[f64] {
        &self.rates[k * m..(k + 1) * m]
    }
}

pub(crate) fn smoothed_trajectories(
    system: &System,
    records: &[Record],
    declared: &[Option<SensorNoise>],
) -> Vec<SmoothedTrajectory> {
    let curve = |r: &Record| smoothed_trajectory(system, r, declared);
    records.iter().map(curve).collect()
}

fn smoothed_trajectory(
    system: &System,
    record: &Record,
    declared: &[Option<SensorNoise>],
) -> SmoothedTrajectory {
    let (n, m, length) = (system.states.len(), system.laws.len(), record.len());
    let mut curve = SmoothedTrajectory {
        states: vec![0.0; length * n],
        rates: vec![0.0; length * m],
        noise: vec![None; n],
        jumps: Vec::new(),
    };
    for (l, law) in system.laws.iter().enumerate() {
        let order = usize::from(law.target.der);
        let first = law.state + 1 - order;
        // Derivatives 0 … order of the variable.
        let mut chain: Vec<Option<Vec<f64>>> = vec![None; order + 1];
        for d in 0..order {
            let i = first + d;
            let column = &record.measured[i];
            if column.iter().all(|x| x.is_nan()) {
                continue;
            }
            let sigma = declared[i].map(|noise| noise.rms(column));
            let breaks = match system.lowest_jump(law.target.var) {
                Some(order) => jump_rows(&record.time, column, order.saturating_sub(d as u8)),
                None => Vec::new(),
            };
            curve.jumps.extend(breaks.iter().map(|b| b.row));
            let Some(s) = data::smooth(&record.time, column, sigma, &breaks, false) else {
                continue;
            };
            curve.noise[i] = Some(s.sigma);
            chain[d] = Some(s.values);
            for (up, values) in [(1, s.slope), (2, s.curvature)] {
                if d + up <= order && chain[d + up].is_none() {
                    chain[d + up] = Some(values);
                }
            }
        }
        for d in 1..=order {
            if chain[d].is_none() {
                chain[d] = chain[d - 1].as_ref().map(|x| gradient(&record.time, x));
            }
        }
        for d in (0..order).rev() {
            if chain[d].is_none() {
                chain[d] = chain[d + 1]
                    .as_ref()
                    .map(|x| cumulative_trapezoid(&record.time, x));
            }
        }
        for (d, values) in chain.into_iter().enumerate() {
            let values = values.unwrap_or_else(|| vec![0.0; length]);
            for (k, x) in values.into_iter().enumerate() {
                if d < order {
                    curve.states[k * n + first + d] = x;
                } else {
                    curve.rates[k * m + l] = x;
                }
            }
        }
    }
    curve.jumps.sort_unstable();
    curve.jumps.dedup();
    curve
}

/// Central differences, one-sided at the ends.
pub(crate) fn gradient(time: &[f64], x: &[f64]) -> Vec<f64> {
    let last = x.len().saturating_sub(1);
    (0..x.len())
        .map(|k| {
            let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
            (x[b] - x[a]) / (time[b] - time[a])
        })
        .collect()
}

/// The integral by the trapezoidal rule, from zero.
fn cumulative_trapezoid(time: &[f64], x: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    (0..x.len())
        .map(|k| {
            if k > 0 {
                sum += 0.5 * (x[k] + x[k - 1]) * (time[k] - time[k - 1]);
            }
            sum
        })
        .collect()
}
