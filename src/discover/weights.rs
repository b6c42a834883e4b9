//! What the data's own errors allow: a weight for each row, the tolerance of the fit, the floor below which residuals say nothing.

use std::borrow::Cow;

use crate::data::{Origin, Samples};
use crate::library::Library;
use crate::term::Signal;

/// Rounding of measured data, relative: a residual below it is not evidence.
const ROUNDING: f64 = 1e-9;
/// Error estimates are good to a small factor; a residual within it is no evidence.
const SAFETY: f64 = 3.0;

/// Longest series whose correlations are summed as it stands.
const SUMMED: usize = 20_000;

/// The error model of one equation on M rows.
#[derive(Clone, Debug)]
pub struct Weights {
    /// Factor of each row, length M; 1 for rows of usual accuracy, less for worse ones.
    pub row: Vec<f64>,
    /// Median error of a row, in units of the target; 0 if everything was measured.
    pub usual: f64,
    /// Estimated ‖W e‖₂ of the weighted error; 0 if everything was measured.
    pub tolerance: f64,
    /// Variance of the weighted error of one row, never zero.
    pub floor: f64,
    /// Rows over which errors are correlated.
    pub correlation: f64,
    /// Root mean square of the target's estimated error, weighted; 0 if it was measured.
    pub target_error: f64,
}

impl Weights {
    /// Combines the estimated errors of the target and of the signals in the library. `y` is the target without known parts.
    pub fn new(samples: &Samples, target: Signal, library: &Library, y: &[f64]) -> Weights {
        let size = rms(y);
        let target_errors = errors(samples, target);
        let mut square = vec![0.0; samples.len()];
        add_squares(&mut square, target_errors.as_deref(), 1.0);
        let mut correlation = correlation_of(samples, target);
        for s in library.signals() {
            correlation = correlation.max(correlation_of(samples, s));
            if let Some(c) = samples.column(s)
                && s != target
            {
                // A term's error matters in proportion to its share of the target, at most all of it.
                let scale = size / rms(&c.values).max(f64::MIN_POSITIVE);
                add_squares(&mut square, errors(samples, s).as_deref(), scale);
            }
        }
        let error: Vec<f64> = square.iter().map(|e| e.sqrt()).collect();
        let usual = median(&error);
        let rounding = ROUNDING * size;
        let estimated = usual > 0.0;
        let row: Vec<f64> = if estimated {
            error.iter().map(|e| usual / e.max(usual)).collect()
        } else {
            vec![1.0; samples.len()]
        };
        let weighted = |e: &[f64]| -> Vec<f64> { e.iter().zip(&row).map(|(e, w)| e * w).collect() };
        let floor = (SAFETY * usual).max(rounding);
        Weights {
            usual,
            tolerance: norm(&weighted(&error)),
            floor: (floor * floor).max(f64::MIN_POSITIVE),
            correlation,
            target_error: target_errors.map_or(0.0, |e| rms(&weighted(&e))),
            row,
        }
    }

    /// Rows whose errors are independent and of size one; residuals below `floor` are no evidence.
    pub fn known(rows: usize, floor: f64) -> Weights {
        Weights {
            usual: 1.0,
            row: vec![1.0; rows],
            tolerance: (rows as f64).sqrt(),
            floor: floor * floor,
            correlation: 1.0,
            target_error: 1.0,
        }
    }

    /// Estimated error of a row, in units of the target, but at least the usual one.
    pub fn error(&self, row: usize) -> f64 {
        self.usual / self.row[row]
    }

    /// What the whole library leaves, row by row: errors that follow each other count as one.
    pub fn seen_residual(&mut self, residual: &[f64]) {
        self.correlation = self.correlation.max(correlation_time(residual));
    }

    /// Terms that cancel leave their own rounding behind: `largest` is the root mean square of the largest contribution.
    pub fn seen_contribution(&mut self, largest: f64) {
        self.floor = self.floor.max((ROUNDING * largest).powi(2));
    }

    /// Where the whole library leaves a visible residual of this size, that is the noise, and the estimate was pessimistic.
    pub fn seen_noise(&mut self, noise: f64) {
        self.floor = self.floor.min((noise * noise).max(f64::MIN_POSITIVE));
    }
}

/// The standard error of every value: estimated, or as declared for the sensor.
fn errors(samples: &Samples, s: Signal) -> Option<Cow<'_, [f64]>> {
    match &samples.column(s)?.origin {
        Origin::Measured { noise } => noise.map(|sigma| vec![sigma; samples.len()].into()),
        Origin::Estimated { error, .. } => Some(error.into()),
    }
}

fn correlation_of(samples: &Samples, s: Signal) -> f64 {
    match samples.column(s).map(|c| &c.origin) {
        Some(Origin::Estimated { correlation, .. }) => *correlation,
        _ => 1.0,
    }
}

fn add_squares(sum: &mut [f64], errors: Option<&[f64]>, scale: f64) {
    for (s, e) in sum.iter_mut().zip(errors.unwrap_or_default()) {
        *s += (scale * e).powi(2);
    }
}

/// Rows over which a series repeats itself: 1 + 2 Σ ρ_k, summed as far as five times itself (Sokal 1997).
///
/// Longer series are averaged in pairs first (Flyvbjerg & Petersen 1989), so that a drifting residual of a million rows costs
/// no more than a few sums over it.
pub(super) fn correlation_time(series: &[f64]) -> f64 {
    let square: f64 = series.iter().map(|x| x * x).sum();
    if square == 0.0 {
        return 1.0;
    }
    if series.len() > SUMMED {
        let pairs = series.chunks_exact(2);
        let means: Vec<f64> = pairs.map(|p| 0.5 * (p[0] + p[1])).collect();
        let kept = means.iter().map(|x| x * x).sum::<f64>() / square;
        return (4.0 * kept * correlation_time(&means)).max(1.0);
    }
    let mut time = 1.0;
    for k in 1..series.len() / 4 {
        let product: f64 = series.iter().zip(&series[k..]).map(|(a, b)| a * b).sum();
        time += 2.0 * product / square;
        if k as f64 >= 5.0 * time {
            break;
        }
    }
    time.max(1.0)
}

/// Euclidean length.
pub(super) fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Root mean square.
pub(super) fn rms(v: &[f64]) -> f64 {
    norm(v) / (v.len().max(1) as f64).sqrt()
}

fn median(v: &[f64]) -> f64 {
    let mut sorted = v.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::correlation_time;
    use crate::numbers::Numbers;

    /// x_i = 0.9 x_{i−1} + noise repeats itself over (1 + 0.9)/(1 − 0.9) = 19 rows.
    fn autoregressive(n: usize) -> Vec<f64> {
        let (mut numbers, mut x) = (Numbers(7), 0.0);
        let step = |_| {
            x = 0.9 * x + numbers.next();
            x
        };
        (0..n).map(step).collect()
    }

    #[test]
    fn correlation_is_the_same_for_long_series_and_short_ones() {
        for n in [10_000, 19_999, 50_000, 300_000] {
            let time = correlation_time(&autoregressive(n));
            assert!((14.0..25.0).contains(&time), "{n}: {time}");
        }
    }

    #[test]
    fn series_without_memory_count_every_row() {
        let alternating: Vec<f64> = (0..50_000).map(|i| f64::from(1 - 2 * (i % 2))).collect();
        assert_eq!(correlation_time(&alternating), 1.0);
        assert_eq!(correlation_time(&[0.0; 10]), 1.0);
    }
}
