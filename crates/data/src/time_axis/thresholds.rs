//! The numbers that decide what is an even grid and what is a gap.

sidc_thresholds::family! {
    /// How sampling instants are understood.
    pub(crate) TIME_AXIS: TimeAxisThresholds {
        /// Steps longer than this, and than the next number says, are gaps.
        gap_over_median: f64 = 4.5, unit "median steps", source "set by hand";
        /// The same against the 95th percentile, since records sampled at random have long steps that are no gaps.
        gap_over_percentile: f64 = 2.0, unit "95th percentiles", source "set by hand";
        /// Half a unit of the last printed digit, with a little for the arithmetic.
        rounding: f64 = 0.51, unit "of the last digit's unit", source "rounding errs by half a unit at most";
        /// Coarsest digits that may explain uneven steps; coarser ones would make a lost sample look like rounding.
        coarsest_digit: f64 = 0.3, unit "steps", source "set by hand";
        /// Deviation from an even grid that is allowed whatever the digits.
        tolerance: f64 = 1e-6, unit "steps", source "set by hand";
        /// Largest deviation for which a grid counts as even where derivatives are computed.
        even: f64 = 1e-4, unit "steps", source "set by hand";
    }
}
