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

family! {
    /// Candidate terms that are the target in other words.
    pub(crate) TARGET_COPIES: TargetCopies {
        /// Library that is looked through.
        max_terms: usize = 20_000, unit "terms", source "20,000 terms on 1,000 rows take some 20 ms";
        /// Sine of the angle below which two columns are one: their products carry half the digits.
        rounding: f64 = 1e-7, unit "", source "square root of ten rounding errors of a double";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![
        TargetCopies::table(),
        RowWeights::table(),
        Autocorrelation::table(),
    ]
}
