//! The numbers that decide how derivatives are estimated, and how much noise a channel has.

sidc_thresholds::family! {
    /// Which local polynomial estimates a derivative.
    pub(crate) BANDWIDTH: BandwidthSelection {
        /// Squared error below which a local choice replaces the one for the whole record.
        local_gain: f64 = 0.4, unit "of the common choice's", source "the local error is estimated from a few windows and known to a factor of two; a gain of less may be chance";
        /// Squared error, in geometric mean over the least, from which wider windows of a degree are not tried.
        hopeless: f64 = 1e6, unit "", source "set by hand";
        /// Mean square of the contrast from which what exceeds it is bias for certain.
        certain_bias: f64 = 4.0, unit "of the noise variance", source "two standard deviations of the contrast";
        /// Bias that may hide in the noise of the contrast.
        hidden_bias: f64 = 0.5, unit "of the noise variance", source "a contrast is its noise plus bias; its square has a standard deviation of √2 noise variances, and windows share readings";
        /// Samples on which the choice for a whole record is made, on an even grid.
        max_samples: usize = 16_384, unit "samples", source "set by hand";
        /// The same on an uneven grid, where every sample has a stencil of its own.
        max_samples_uneven: usize = 4_096, unit "samples", source "set by hand";
        /// Choices kept beside the common one on records longer than that.
        max_alternatives: usize = 4, unit "choices", source "set by hand";
        /// A choice is kept if it is the best at more than one sample in so many.
        min_wins: usize = 2000, unit "samples", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// How the noise of a channel is estimated from its differences.
    pub(crate) NOISE: NoiseEstimation {
        /// Lowest order of difference; lower ones still contain the signal.
        min_order: usize = 2, unit "", source "set by hand";
        /// Highest order of difference.
        max_order: usize = 10, unit "", source "a sine of twelve samples a period leaves 1.4e-3 of itself in the tenth difference, (2 sin(π/12))^10, noise 430 times itself, √C(20,10)";
        /// Places at which differences are taken, at most.
        max_places: usize = 20_000, unit "places", source "set by hand";
        /// Fewest differences of one order for a median.
        min_differences: usize = 6, unit "differences", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// When a record is taken to be rounded to multiples of a quantum.
    pub(crate) QUANTIZATION: QuantizationThresholds {
        /// Fewest steps that are not zero.
        min_moves: usize = 8, unit "steps", source "set by hand";
        /// A rounded record repeats its value at one step in so many, or more often.
        max_moves_per_repeat: usize = 20, unit "steps", source "set by hand";
        /// Steps that must be whole multiples of the quantum.
        multiples: f64 = 0.95, unit "of all steps", source "set by hand";
        /// Deviation from a whole multiple that is rounding in memory.
        tolerance: f64 = 1e-3, unit "of the quantum", source "set by hand";
        /// A step larger than this shows that not all steps are equal.
        larger_step: f64 = 1.5, unit "quanta", source "between one and two";
        /// Range from which even equal steps are rounding; a relay has fewer levels.
        min_range: f64 = 4.5, unit "quanta", source "set by hand";
    }
}
