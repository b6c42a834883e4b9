//! Whittaker's smoother for a first guess of the motion: penalised third differences, the penalty by generalised cross-validation.
//!
//! In: times and values of one segment. Out: smoothed values, and the standard deviation of what was taken off. Errors of this guess are
//! corrected to first order later. It is used in place of `data::smooth` because of clean records: there the latter sees rounding noise only,
//! while the noise here counts all that a smooth curve through the samples cannot follow, by which the integrals are off.

use super::banded_cholesky::{Banded, BandedCholesky};
use super::thresholds::WEAK_FORM;
use sidc_data::median_step;

/// Order of the differences.
const DIFFERENCE_ORDER: usize = 3;

/// SmoothedRecord values and the noise that they leave.
pub(super) struct SmoothedRecord {
    pub values: Vec<f64>,
    /// Standard deviation of white noise on the record.
    pub noise: f64,
}

/// min Σ (y − x)² + λ Σ (x‴)² with divided differences, so that times may be uneven. λ is searched on a grid in log λ, then about its
/// best point.
pub(super) fn smooth(time: &[f64], y: &[f64]) -> SmoothedRecord {
    let rough = Roughness::new(time);
    let mut best: Option<(f64, Trial)> = None;
    let consider = |best: &mut Option<(f64, Trial)>, log: f64| {
        if let Some(t) = rough.fit(10f64.powf(log), y)
            && best.as_ref().is_none_or(|(_, b)| t.score < b.score)
        {
            *best = Some((log, t));
        }
    };
    for half in -12..=24 {
        consider(&mut best, 0.5 * f64::from(half));
    }
    let middle = best.as_ref().map_or(0.0, |(log, _)| *log);
    for step in [-0.375, -0.25, -0.125, 0.125, 0.25, 0.375] {
        consider(&mut best, middle + step);
    }
    let largest = y.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let least = 1e-12 * largest;
    match best {
        Some((_, t)) => SmoothedRecord {
            noise: t.noise.max(least),
            values: t.values,
        },
        None => SmoothedRecord {
            values: y.to_vec(),
            noise: least,
        },
    }
}

struct Trial {
    values: Vec<f64>,
    score: f64,
    noise: f64,
}

/// Third divided differences, time in median steps.
struct Roughness {
    rows: Vec<[f64; DIFFERENCE_ORDER + 1]>,
}

impl Roughness {
    fn new(time: &[f64]) -> Roughness {
        let step = median_step([time]).unwrap_or(1.0);
        let row = |t: &[f64]| {
            let mut out = [0.0; DIFFERENCE_ORDER + 1];
            for (j, weight) in out.iter_mut().enumerate() {
                let others = t.iter().enumerate().filter(|(k, _)| *k != j);
                *weight = 6.0 / others.map(|(_, s)| (t[j] - s) / step).product::<f64>();
            }
            out
        };
        Roughness {
            rows: time.windows(DIFFERENCE_ORDER + 1).map(row).collect(),
        }
    }

    fn factor(&self, n: usize, weight: f64) -> Option<BandedCholesky> {
        let mut a = Banded::zero(n, DIFFERENCE_ORDER);
        for i in 0..n {
            a.add(i, i, 1.0);
        }
        for (first, row) in self.rows.iter().enumerate() {
            for (i, x) in row.iter().enumerate() {
                for (j, y) in row.iter().enumerate().take(i + 1) {
                    a.add(first + i, first + j, weight * x * y);
                }
            }
        }
        a.cholesky()
    }

    fn fit(&self, weight: f64, y: &[f64]) -> Option<Trial> {
        let n = y.len();
        let factor = self.factor(n, weight)?;
        let mut values = y.to_vec();
        factor.solve(&mut values);
        let rss: f64 = y.iter().zip(&values).map(|(y, x)| (y - x).powi(2)).sum();
        let freedom = factor.trace_of_inverse();
        let left = n as f64 - WEAK_FORM.freedom_price * freedom;
        (left > 1.0).then(|| Trial {
            values,
            score: (rss.max(f64::MIN_POSITIVE) / (left * left)).ln(),
            noise: (rss / (n as f64 - freedom)).sqrt(),
        })
    }
}
