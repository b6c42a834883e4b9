//! A portmanteau test of white residuals (Box & Pierce 1970): one figure for their first autocorrelations, and its bound.

use crate::thresholds::WHITENESS;

pub use crate::thresholds::WHITENESS_LAGS;

/// Root mean square of the autocorrelations at lags 1 … [`WHITENESS_LAGS`]: 0 for white residuals.
pub fn rms_autocorrelation(correlations: &[f64; WHITENESS_LAGS]) -> f64 {
    (correlations.iter().map(|r| r * r).sum::<f64>() / WHITENESS_LAGS as f64).sqrt()
}

/// What [`rms_autocorrelation`] of so many white residuals stays below: M Σ r² is about χ² with one degree of freedom for each lag.
pub fn white_noise_bound(residuals: f64) -> f64 {
    ((1.0 + WHITENESS.deviations * (2.0 / WHITENESS_LAGS as f64).sqrt()) / residuals).sqrt()
}
