//! Whether residuals are white: one figure for their first autocorrelations, and what chance allows it to be.

/// Lags looked at.
pub const LAGS: usize = 8;
/// Standard deviations that chance is allowed.
const ALLOWED: f64 = 5.0;

/// Root mean square of the autocorrelations at lags 1 … [`LAGS`]: 0 for white residuals.
pub fn size(correlations: &[f64; LAGS]) -> f64 {
    (correlations.iter().map(|r| r * r).sum::<f64>() / LAGS as f64).sqrt()
}

/// What [`size`] may be of so many white residuals: M Σ r² is about χ² of as many degrees of freedom as lags, less what the fit took.
pub fn chance(residuals: f64) -> f64 {
    ((1.0 + ALLOWED * (2.0 / LAGS as f64).sqrt()) / residuals).sqrt()
}
