//! How residuals of successive samples follow each other.
//!
//! In discrete time x_{k+1} is regressed on x_k. Noise of the process leaves white residuals and right coefficients; noise of the
//! sensors enters both sides, leaves residuals that follow each other, and draws coefficients towards zero (errors in variables;
//! Söderström & Stoica, System Identification, 1989, chapter 7). In: residuals by row. Out: their autocorrelation, and what chance allows.

use crate::data::Samples;

/// Lags looked at.
const LAGS: usize = 8;
/// Standard deviations that chance is allowed.
const ALLOWED: f64 = 5.0;
/// Pairs of neighbours under which nothing is said.
const FEW: usize = 50;

/// What residuals remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Memory {
    /// Root mean square of the autocorrelation over the first lags, with the sign of the first.
    pub is: f64,
    pub chance: f64,
}

/// `None` where few rows are neighbours.
pub(super) fn memory(left: &[f64], samples: &Samples) -> Option<Memory> {
    let steps = samples.time.windows(2).map(|t| t[1] - t[0]);
    let step = steps.filter(|h| *h > 0.0).fold(f64::INFINITY, f64::min);
    // Whether the row that many places on is that many samples later.
    let follows = |i: usize, lag: usize| {
        let apart = samples.time[i + lag] - samples.time[i];
        samples.trajectory[i] == samples.trajectory[i + lag] && apart < (lag as f64 + 0.5) * step
    };
    let mut correlation = [0.0; LAGS];
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
    let mean = (correlation.iter().map(|r| r * r).sum::<f64>() / LAGS as f64).sqrt();
    // M Σ r² is about χ² of as many degrees of freedom as lags.
    let chance = (1.0 + ALLOWED * (2.0 / LAGS as f64).sqrt()) / neighbours as f64;
    (neighbours >= FEW && mean.is_finite()).then(|| Memory {
        is: mean.copysign(correlation[0]),
        chance: chance.sqrt(),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn samples(rows: usize, apart: impl Fn(usize) -> f64) -> Samples {
        Samples {
            trajectory: vec![0; rows],
            time: (0..rows).map(apart).collect(),
            columns: Vec::new(),
        }
    }

    fn noise(rows: usize) -> Vec<f64> {
        let mut seed = 9u64;
        let step = |_| {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        (0..rows).map(step).collect()
    }

    #[test]
    fn white_residuals_are_within_chance_and_others_are_not() {
        let white = noise(2000);
        let even = samples(2000, |k| k as f64);
        let found = memory(&white, &even).unwrap();
        assert!(found.is.abs() < found.chance, "{found:?}");
        // e_k − e_{k−1}/2: −0.4 at the first lag, nothing beyond.
        let moving: Vec<f64> = (0..2000)
            .map(|k| white[k] - 0.5 * if k > 0 { white[k - 1] } else { 0.0 })
            .collect();
        let found = memory(&moving, &even).unwrap();
        assert!((found.is + 0.4 / 8f64.sqrt()).abs() < 0.02, "{found:?}");
        assert!(found.is.abs() > found.chance);
    }

    #[test]
    fn rows_that_are_no_neighbours_say_nothing() {
        let white = noise(200);
        assert_eq!(memory(&white, &samples(200, |k| (k * k) as f64)), None);
        assert_eq!(memory(&white[..40], &samples(40, |k| k as f64)), None);
        assert_eq!(memory(&[], &samples(0, |k| k as f64)), None);
        let mut apart = samples(200, |k| k as f64);
        apart.trajectory = (0..200).collect();
        assert_eq!(memory(&white, &apart), None);
    }
}
