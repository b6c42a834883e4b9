//! Records → smooth curves through them, for a start: states, rates, and the noise that smoothing sees.
//!
//! In: records. Out: a [`Curve`] each. What is measured is smoothed; what is not is differentiated from below, or integrated from above.

use super::record::Record;
use super::system::System;
use crate::data;

/// A smooth guess of a trajectory.
#[derive(Clone, Debug, Default)]
pub(super) struct Curve {
    /// Samples × n.
    pub states: Vec<f64>,
    /// Samples × laws.
    pub rates: Vec<f64>,
    /// Of each state's sensor; `None` where it is not measured.
    pub noise: Vec<Option<f64>>,
}

impl Curve {
    pub fn at(&self, k: usize, n: usize) -> &[f64] {
        &self.states[k * n..(k + 1) * n]
    }

    pub fn rate_at(&self, k: usize, m: usize) -> &[f64] {
        &self.rates[k * m..(k + 1) * m]
    }
}

pub(super) fn curves(system: &System, records: &[Record], declared: &[Option<f64>]) -> Vec<Curve> {
    let curve = |r: &Record| curve(system, r, declared);
    records.iter().map(curve).collect()
}

fn curve(system: &System, record: &Record, declared: &[Option<f64>]) -> Curve {
    let (n, m, length) = (system.states.len(), system.laws.len(), record.len());
    let mut curve = Curve {
        states: vec![0.0; length * n],
        rates: vec![0.0; length * m],
        noise: vec![None; n],
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
            let Some(s) = data::smooth(&record.time, column, declared[i], &[], false) else {
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
                chain[d] = chain[d + 1].as_ref().map(|x| integral(&record.time, x));
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
    curve
}

/// Slope through each sample's neighbours.
fn gradient(time: &[f64], x: &[f64]) -> Vec<f64> {
    let last = x.len().saturating_sub(1);
    (0..x.len())
        .map(|k| {
            let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
            (x[b] - x[a]) / (time[b] - time[a])
        })
        .collect()
}

/// By trapezoids, from zero.
fn integral(time: &[f64], x: &[f64]) -> Vec<f64> {
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
