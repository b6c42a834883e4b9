//! Autocorrelation of the residuals of successive samples.
//!
//! In: residuals by row. Out: their autocorrelation, and what chance allows. In discrete time x_{k+1} is regressed on x_k: process
//! noise leaves white residuals, but sensor noise enters both sides, colours the residuals and draws coefficients towards zero (errors
//! in variables; Söderström & Stoica 1989, System Identification, chapter 7). Never corrects coefficients.

use crate::doubts::thresholds::BADLY_FITTED_ROWS;
use sidc_data::Samples;
use sidc_solve::{WHITENESS_LAGS, rms_autocorrelation, white_noise_bound};

/// Autocorrelation of residuals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ResidualAutocorrelation {
    /// Root mean square of the autocorrelation over the first lags, with the sign of the first.
    pub value: f64,
    /// What white noise stays below.
    pub bound: f64,
}

/// `left`: residuals by row. `None` if too few rows are successive samples.
pub(crate) fn measure(left: &[f64], samples: &Samples) -> Option<ResidualAutocorrelation> {
    let steps = samples.time.windows(2).map(|t| t[1] - t[0]);
    let step = steps.filter(|h| *h > 0.0).fold(f64::INFINITY, f64::min);
    // Whether the row `lag` places on is `lag` samples later.
    let follows = |i: usize, lag: usize| {
        let apart = samples.time[i + lag] - samples.time[i];
        samples.trajectory[i] == samples.trajectory[i + lag] && apart < (lag as f64 + 0.5) * step
    };
    let mut correlation = [0.0; WHITENESS_LAGS];
    let mut neighbours = 0;
    for (lag, r) in (1..).zip(&mut correlation) {
        let rows = 0..left.len().saturating_sub(lag);
        let pairs: Vec<usize> = rows.filter(|i| follows(*i, lag)).collect();
        let square: f64 = pairs.iter().map(|i| left[*i] * left[*i]).sum();
        let product: f64 = pairs.iter().map(|i| left[*i] * left[i + lag]).sum();
        *r = product / square.max(f64::MIN_POSITIVE);
        if lag == 1 {
            neighbours = pairs.len();
        }
    }
    let size = rms_autocorrelation(&correlation);
    (neighbours >= BADLY_FITTED_ROWS.min_neighbours && size.is_finite()).then(|| {
        ResidualAutocorrelation {
            value: size.copysign(correlation[0]),
            bound: white_noise_bound(neighbours as f64),
        }
    })
}

/// The same of rows in the order of a signal's values: right laws leave white residuals in every order (a test of lack of fit; Hart 1997,
/// Nonparametric Smoothing and Lack-of-Fit Tests, chapter 5).
pub(crate) fn along(left: &[f64], signal: &[f64]) -> Option<ResidualAutocorrelation> {
    let mut order: Vec<usize> = (0..left.len()).collect();
    order.sort_by(|a, b| signal[*a].total_cmp(&signal[*b]));
    let rows = Samples {
        trajectory: vec![0; order.len()],
        time: (0..order.len()).map(|k| k as f64).collect(),
        columns: Vec::new(),
    };
    let left: Vec<f64> = order.iter().map(|k| left[*k]).collect();
    measure(&left, &rows)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use sidc_random::Numbers;

    fn samples(rows: usize, apart: impl Fn(usize) -> f64) -> Samples {
        Samples {
            trajectory: vec![0; rows],
            time: (0..rows).map(apart).collect(),
            columns: Vec::new(),
        }
    }

    #[test]
    fn white_residuals_are_within_chance_and_others_are_not() {
        let white = Numbers(9).many(2000);
        let even = samples(2000, |k| k as f64);
        let found = measure(&white, &even).unwrap();
        assert!(found.value.abs() < found.bound, "{found:?}");
        // e_k − e_{k−1}/2: −0.4 at the first lag, nothing beyond.
        let moving: Vec<f64> = (0..2000)
            .map(|k| white[k] - 0.5 * if k > 0 { white[k - 1] } else { 0.0 })
            .collect();
        let found = measure(&moving, &even).unwrap();
        assert!((found.value + 0.4 / 8f64.sqrt()).abs() < 0.02, "{found:?}");
        assert!(found.value.abs() > found.bound);
    }

    #[test]
    fn rows_that_are_no_neighbours_say_nothing() {
        let white = Numbers(9).many(200);
        assert_eq!(measure(&white, &samples(200, |k| (k * k) as f64)), None);
        assert_eq!(measure(&white[..40], &samples(40, |k| k as f64)), None);
        assert_eq!(measure(&[], &samples(0, |k| k as f64)), None);
        let mut apart = samples(200, |k| k as f64);
        apart.trajectory = (0..200).collect();
        assert_eq!(measure(&white, &apart), None);
    }
}
