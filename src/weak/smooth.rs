//! A first guess of the motion behind a noisy record: penalised third differences, their weight by cross-validation.
//!
//! In: times and values of one stretch. Out: the smoothed values, and the standard deviation of what was taken off. What the
//! guess gets wrong is corrected to first order afterwards, so it need not be the best there is. `data::smooth` would do as well in noise; on
//! clean records its noise is that of rounding, while here it counts all that a smooth curve through the samples cannot follow, which is what
//! the integrals are off by.

use super::banded::{Banded, Factor};

/// How much dearer than its due a degree of freedom is: plain cross-validation follows noise now and then (Gu 2013, section 3.2).
const DEAR: f64 = 1.2;
/// Order of the differences.
const ORDER: usize = 3;

/// Smoothed values and the noise that they leave.
pub(super) struct Smoothed {
    pub values: Vec<f64>,
    /// Standard deviation of white noise on the record.
    pub noise: f64,
}

/// Whittaker's smoother min Σ (y − x)² + λ Σ (x‴)², λ by generalised cross-validation. Uneven times are taken as they are.
pub(super) fn smooth(time: &[f64], y: &[f64]) -> Smoothed {
    let rough = Roughness::new(time);
    let mut best: Option<(f64, Trial)> = None;
    let mut consider = |log: f64| -> f64 {
        match rough.fit(10f64.powf(log), y) {
            Some(t) => {
                let score = t.score;
                if best.as_ref().is_none_or(|(_, b)| score < b.score) {
                    best = Some((log, t));
                }
                score
            }
            None => f64::INFINITY,
        }
    };
    for half in -12..=24 {
        consider(0.5 * f64::from(half));
    }
    let middle = best.as_ref().map_or(0.0, |(log, _)| *log);
    let mut refine = |log: f64| {
        if let Some(t) = rough.fit(10f64.powf(log), y)
            && best.as_ref().is_none_or(|(_, b)| t.score < b.score)
        {
            best = Some((log, t));
        }
    };
    for step in [-0.375, -0.25, -0.125, 0.125, 0.25, 0.375] {
        refine(middle + step);
    }
    let largest = y.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let least = 1e-12 * largest;
    match best {
        Some((_, t)) => Smoothed {
            noise: t.noise.max(least),
            values: t.values,
        },
        None => Smoothed {
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

/// Third divided differences, in steps of the median.
struct Roughness {
    rows: Vec<[f64; ORDER + 1]>,
}

impl Roughness {
    fn new(time: &[f64]) -> Roughness {
        let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        let step = steps.get(steps.len() / 2).copied().unwrap_or(1.0);
        let row = |t: &[f64]| {
            let mut out = [0.0; ORDER + 1];
            for (j, weight) in out.iter_mut().enumerate() {
                let others = t.iter().enumerate().filter(|(k, _)| *k != j);
                *weight = 6.0 / others.map(|(_, s)| (t[j] - s) / step).product::<f64>();
            }
            out
        };
        Roughness {
            rows: time.windows(ORDER + 1).map(row).collect(),
        }
    }

    fn factor(&self, n: usize, weight: f64) -> Option<Factor> {
        let mut a = Banded::zero(n, ORDER);
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
        let left = n as f64 - DEAR * freedom;
        (left > 1.0).then(|| Trial {
            values,
            score: (rss.max(f64::MIN_POSITIVE) / (left * left)).ln(),
            noise: (rss / (n as f64 - freedom)).sqrt(),
        })
    }
}
