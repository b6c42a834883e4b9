//! Numbers that decide in what all methods share: the errors of rows, and autocorrelation.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// What the data's own errors allow a residual to say.
    pub(crate) ROW_WEIGHTS: RowWeights {
        /// Rounding of measured data: a residual below it is no evidence.
        rounding: f64 = 1e-9, unit "of the target or the largest term", source "set by hand";
        /// Error estimates are right to a small factor: a residual within it is no evidence.
        error_safety: f64 = 3.0, unit "standard errors", source "set by hand";
    }
}

family! {
    /// The estimate of integrated autocorrelation times.
    pub(crate) AUTOCORRELATION: Autocorrelation {
        /// Lags over which autocorrelations are summed.
        window: f64 = 5.0, unit "autocorrelation times", source "Sokal 1997, Monte Carlo Methods in Statistical Mechanics, section 3";
        /// Longest series that is not averaged in pairs first; bounds the work.
        direct_length: usize = 20_000, unit "numbers", source "set by hand";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![RowWeights::table(), Autocorrelation::table()]
}
