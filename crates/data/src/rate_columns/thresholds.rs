//! The numbers that decide whether a column is the rate of its state.

sidc_thresholds::family! {
    /// When a measured rate is held against the samples of its state, and when it contradicts them.
    pub(crate) RATES: RateColumnThresholds {
        /// Standard errors from which a bias, a gain, a lag or a smoothing is no chance; the error is at least that between ten parts of the record.
        significance: f64 = 6.0, unit "standard errors", source "Student's t of the nine degrees of freedom between ten parts: two in ten thousand";
        /// Deviance above the least up to which a ratio of the two noises is likely.
        likely: f64 = 4.0, unit "deviance", source "two standard errors: 95 % of a chi-square with one degree of freedom is 3.84";
        /// Share of the rate from which a fault is a fault of its sensor.
        effect: f64 = 1e-3, unit "of the rate's rms", source "the error that instruments of class 0.1 may have (IEC 60051)";
        /// Parts of the record between which errors are compared.
        parts: usize = 10, unit "parts", source "enough for a variance, few enough to be longer than the memory of the errors";
        /// Fewest steps between gaps and jumps of an input that are used.
        min_steps: usize = 7, unit "steps", source "one more than the six samples of the finer quadrature";
        /// Fewest steps in all.
        min_all: usize = 30, unit "steps", source "three in each of the ten parts";
        /// Instants at which the accumulated difference is compared, at most.
        max_instants: usize = 4000, unit "instants", source "a cost of milliseconds; the quadrature uses all samples";
        /// Part of a column's variance that the other columns must leave for its coefficient to be told.
        independent: f64 = 1e-9, unit "of the variance", source "the square root of the rounding of sums of squares, with a digit to spare";
        /// Part of the changes from sample to sample that is rough from which a rate that does not follow its state is not told.
        rough: f64 = 0.5, unit "of the variance of the changes", source "half: beyond it a sample tells more of itself than of its neighbours";
        /// Correlation with the rises of the state below which a column is another signal.
        unrelated: f64 = 0.5, unit "", source "half: less than half of the motion in common";
        /// Deviation from a ratio of units that still explains a factor.
        unit_tolerance: f64 = 0.05, unit "of the ratio", source "the nearest two ratios, 57.3 and 60, are that far apart";
        /// Intervals that a record is cut into for that correlation, then half as many, and so on down to the number of parts.
        intervals: usize = 50, unit "intervals", source "a correlation of one half is then four standard errors";
    }
}

sidc_thresholds::family! {
    /// When a rate was computed from the samples of its state.
    pub(crate) FILTERS: RateFilterThresholds {
        /// Difference to a known formula below which the column was made by it.
        exact: f64 = 0.01, unit "of the error that the formula has", source "two orders of magnitude: a true rate differs from the formula by the formula's error";
        /// Rms that a filter of the samples may leave of a rate with noise of its own.
        shared: f64 = 0.1, unit "of the noise that the filter passes on", source "a hundredth of the variance that an independent measurement leaves at least";
        /// What a short filter leaves from which longer ones are not tried.
        hopeless: f64 = 3.0, unit "of the noise that the filter passes on", source "three times the least that an independent measurement leaves: the rate has noise of its own";
        /// Samples on which formulas are compared.
        places: usize = 400, unit "samples", source "a mean to five per cent, thirty times finer than the bound";
        /// Samples for each weight of a filter that is fitted.
        samples_per_weight: usize = 8, unit "samples", source "weights take an eighth of the variance";
        /// Samples from which a filter is fitted, at most.
        max_samples: usize = 1200, unit "samples", source "a cost of milliseconds with 101 weights";
        /// Longest Savitzky-Golay filter that is recognised by name.
        longest_named: usize = 51, unit "samples", source "the longest filter that is fitted has twice as many";
    }
}
