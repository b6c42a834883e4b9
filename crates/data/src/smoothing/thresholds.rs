//! The numbers that decide how a channel is smoothed.

sidc_thresholds::family! {
    /// Which smoothing parameter and which noise a channel gets.
    pub(crate) SMOOTHING: SmoothingThresholds {
        /// Fewest values that are smoothed.
        min_values: usize = 5, unit "values", source "three fix a parabola, two more show noise";
        /// Factor on the degrees of freedom in the criteria, since plain cross-validation sometimes follows the noise.
        degrees_of_freedom_cost: f64 = 1.2, unit "", source "Cummins, Filloon and Nychka 2001, Journal of the American Statistical Association 96";
        /// Narrowest width that is tried; below it the spline interpolates.
        min_width: f64 = 0.25, unit "median steps", source "narrower than half the spacing a spline passes through its values: every width below gives the same curve";
        /// Narrowest width under cross-validation, which says nothing where nearly every value is a degree of freedom.
        min_width_unknown_noise: f64 = 0.6, unit "median steps", source "a smoothing spline narrower than the spacing takes nearly a degree of freedom for each value";
        /// Widest width that is tried: such a spline bends little more than a parabola, and wider ones would not count their bias.
        max_width: f64 = 0.5, unit "of the record", source "set by hand";
        /// Degrees of freedom from which the residual may be bias instead of noise.
        doubtful: f64 = 0.4, unit "of the values", source "a curve of fewer than 2.5 values for each degree of freedom leaves them too few for both bias and noise";
        /// Fewest values for which the noise is estimated from differences too.
        min_values_for_differences: f64 = 12.0, unit "values", source "set by hand";
        /// Values from which the estimate from differences counts as reliable.
        many_values: f64 = 60.0, unit "values", source "set by hand";
        /// A doubtful residual is bias if differences show less noise than this part of it, in a record of many values.
        noise_ratio: f64 = 0.5, unit "", source "set by hand";
        /// The same in a record of fewer values.
        noise_ratio_of_few: f64 = 0.2, unit "", source "set by hand";
        /// Fewest rows per segment, in the mean, for differences to be taken within segments.
        min_segment: usize = 16, unit "rows", source "differences of all orders, up to ten, must fit";
        /// The noise is rounding if it is no larger than this.
        rounding: f64 = 1.1, unit "of quantum/√12", source "set by hand";
        /// Residual up to which the bounded criterion widens the spline.
        bound_deviations: f64 = 2.0, unit "standard deviations of a mean square", source "by definition: two-sigma bound";
        /// Excess over the bound at which the search for the widest spline stops.
        hopeless_excess: f64 = 4.0, unit "of the bound", source "set by hand";
        /// Degrees of freedom from which the spline only interpolates and the values are kept as they are.
        saturated: f64 = 0.7, unit "of the values", source "then less than a third of the degrees of freedom is left to tell noise";
        /// Part of the posterior variance of value, slope and curvature that is reported. Of it 1 − (2d + 1)/6 is noise that
        /// was let through, and the rest what a signal as rough as the prior would hide; motion is smoother, so half of it counts.
        variance_share: [f64; 3] = [11.0 / 12.0, 9.0 / 12.0, 7.0 / 12.0], unit "", source "Wahba 1978 for the variance; coverage: cargo test -p sidc-cli --test it errors_cover_the_truth";
    }
}

sidc_thresholds::family! {
    /// How the smoothing parameter is searched for.
    pub(crate) SEARCH: SmoothingSearch {
        /// Ratio of neighbouring widths on the coarse grid.
        coarse_ratio: f64 = 1.8, unit "", source "golden section narrows two neighbours to 4 % of a width in its seven steps; half of it is below 1 and no grid";
        /// Golden-section steps between neighbours of the best.
        golden_steps: usize = 7, unit "steps", source "0.618^7 of the ln 3.2 between two neighbours: the width to 4 %, where the criterion is flat";
        /// Ratio by which a search that starts near a known width may leave it.
        warm_start_ratio: f64 = 4.0, unit "", source "set by hand";
        /// Longest record that is searched in full; of longer ones excerpts are taken.
        max_nodes: usize = 32_768, unit "samples", source "set by hand";
        /// Excerpts of a long record.
        excerpts: usize = 12, unit "", source "set by hand";
        /// Length of an excerpt.
        excerpt_nodes: usize = 2_048, unit "samples", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// Which values are outliers.
    pub(crate) OUTLIERS: OutlierThresholds {
        /// Studentised residual beyond which a value is an outlier.
        distance: f64 = 5.0, unit "standard deviations", source "normal noise goes so far once in 1.7 million values";
        /// Passes at most.
        passes: usize = 20, unit "", source "set by hand";
        /// Rows on either side whose residuals measure how well the spline follows there.
        neighbours: usize = 10, unit "rows", source "set by hand";
        /// Fewest values of a segment in which outliers are looked for, unless it is the whole record.
        min_segment: usize = 12, unit "values", source "set by hand";
        /// A record with more outliers than this has another kind of noise, so none is removed.
        max_share: f64 = 0.2, unit "of the values", source "set by hand";
        /// Factor on the tail of the residuals where the fit is doubtful: bias has tails too.
        doubtful_tail: f64 = 2.0, unit "", source "set by hand";
        /// The scale of the residuals is at least this.
        min_scale: f64 = 0.3, unit "of the noise", source "set by hand";
        /// Residual of every neighbour below which an outlier stands alone.
        alone: f64 = 0.6, unit "of the outlier's residual", source "set by hand";
    }
}
