//! The numbers that decide how samples are made and which warnings they get.

sidc_thresholds::family! {
    /// When an absent signal is estimated, and when its estimate is called bad.
    pub(crate) SAMPLING: SamplingThresholds {
        /// Most differentiations between a measured signal and an estimated one.
        max_differentiations: u8 = 3, unit "orders", source "set by hand";
        /// A jump of an input is stepped over where that leaves less than this of the error.
        crossing_error: f64 = 0.5, unit "of the error that respects the jump", source "an estimated error is known to a factor of two: less may be chance";
        /// Fewer rows than these between two jumps count as too short to differentiate within.
        min_rows_between_jumps: usize = 5, unit "rows", source "set by hand";
        /// Part of all rows in such short segments from which `input-changes-often` is reported.
        often: f64 = 0.5, unit "of all rows", source "by definition: most rows";
        /// Median error of an estimate from which `noisy-derivative` is reported.
        noisy_derivative: f64 = 0.3, unit "of the signal's rms", source "set by hand";
    }
}
