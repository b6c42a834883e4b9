//! The numbers that decide which diagnostics a record gets.

sidc_thresholds::family! {
    /// When a bound signal is found strange.
    pub(crate) RECORD: RecordChecks {
        /// Smallest maximum of a signal that can be computed with.
        min_size: f64 = 1e-100, unit "of the model's unit", source "products of three values stay above 1e-308";
        /// Largest value that can be computed with.
        max_size: f64 = 1e100, unit "of the model's unit", source "products of three values stay below 1e308";
        /// Change of a parameter that is rounding.
        param_tolerance: f64 = 1e-12, unit "of its value", source "set by hand";
        /// Least range of an angle that may be wrapped.
        wrapped_min_range: f64 = 0.75, unit "turns", source "an angle that wraps jumps by so much, `wrapped_step`";
        /// Largest range of an angle that may be wrapped.
        wrapped_max_range: f64 = 1.02, unit "turns", source "a turn, and 2 % for noise";
        /// Step from which an angle has wrapped.
        wrapped_step: f64 = 0.75, unit "turns", source "a jump of three quarters of a turn back is a quarter forth: angles sampled four times a turn are told";
        /// Step up to which an angle has moved; between the two it is no angle.
        moved_step: f64 = 0.25, unit "turns", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// When sampling times are found strange.
    pub(crate) TIMES: TimeChecks {
        /// Correction of rounded times that is not mentioned, since no result depends on it.
        silent_correction: f64 = 1e-3, unit "median steps", source "set by hand";
        /// Difference between the shortest and the longest step that is even.
        even_steps: f64 = 0.01, unit "median steps", source "set by hand";
        /// Deviation of a step in discrete time from a whole number of samples.
        whole_step: f64 = 0.05, unit "median steps", source "a median step off by 0.5 % misses the end of a gap of ten by as much";
        /// A time that falls back to within this part of the time passed starts a new record.
        restart: f64 = 0.1, unit "of the time passed", source "set by hand";
        /// Longest table in which a column that numbers the runs is looked for.
        max_rows_compared: usize = 200_000, unit "rows", source "set by hand";
    }
}
