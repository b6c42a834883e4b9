//! Numbers that decide in the analysis of identifiability.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// How much of the analysis a result lists.
    pub(crate) LISTED: ListedIdentifiability {
        /// Pairs of columns with the largest cosines.
        pairs: usize = 5, unit "pairs", source "set by hand";
        /// Relations between columns.
        relations: usize = 12, unit "relations", source "set by hand";
        /// Supports that fit as well as the one found.
        equivalent_supports: usize = 8, unit "supports", source "set by hand";
        /// Columns that are zero on every row.
        zero_columns: usize = 12, unit "columns", source "set by hand";
        /// Terms whose cosines with each other are listed.
        cosine_terms: usize = 16, unit "terms", source "set by hand";
        /// Terms among these that are not in the support.
        cosine_rivals: usize = 8, unit "terms", source "set by hand";
        /// Columns of the data that the model does not read.
        unread_columns: usize = 3, unit "columns", source "set by hand";
    }
}

family! {
    /// When the columns count as related, and by which cause.
    pub(crate) COLLINEARITY: Collinearity {
        /// Residual below which a relation holds exactly.
        exact: f64 = 1e-6, unit "of the largest part", source "set by hand";
        /// Variation below which a signal is constant.
        constant_signal: f64 = 1e-9, unit "of the signal", source "set by hand";
        /// Variation below which an input is constant; it was meant to vary.
        constant_input: f64 = 0.02, unit "of the input", source "set by hand";
        /// Residual up to which a relation explains why two supports fit equally well.
        exchange: f64 = 0.3, unit "of the largest part", source "set by hand";
        /// Columns off the support around which relations are searched.
        seeds: usize = 12, unit "columns", source "set by hand";
        /// Terms of a conserved quantity that is not a sum of states, its value among them.
        conserved_terms: usize = 3, unit "terms", source "set by hand";
        /// Largest value from which a signal stays away from zero.
        away_from_zero: f64 = 2.0, unit "ranges", source "set by hand";
        /// Quantiles between which a signal mostly is.
        central_quantiles: (f64, f64) = (0.025, 0.975), unit "", source "the middle 95 %, by definition";
    }
}

family! {
    /// The search for sparse null vectors: few columns of which a combination nearly vanishes.
    pub(crate) NULL_VECTORS: NullVectorLimits {
        /// Residual of a relation of two, three, … columns of a library. More columns leave little by chance, above all of smooth motion.
        term_residuals: [f64; 5] = [0.05, 0.01, 1e-6, 1e-6, 1e-6], unit "of the largest part", source "set by hand";
        /// The same for relations between signals.
        signal_residuals: [f64; 5] = [1e-3, 1e-3, 1e-3, 1e-3, 1e-3], unit "of the largest variation", source "set by hand";
        /// Residual that is rounding.
        rounding: f64 = 1e-9, unit "of the largest part", source "set by hand";
        /// Weight below which a column does not belong to a relation.
        negligible_weight: f64 = 10.0, unit "residuals", source "set by hand";
        /// Weight above which a column always belongs to it.
        certain_weight: f64 = 0.5, unit "of the largest weight", source "set by hand";
        /// Relations of each length that are kept for a column.
        kept: usize = 4, unit "relations", source "set by hand";
        /// Sets of columns that are extended by another column.
        beam_width: usize = 6, unit "sets", source "set by hand";
        /// Columns up to which all triples are compared.
        exhaustive_columns: usize = 1500, unit "columns", source "set by hand";
        /// Squared sine of the angle to other columns below which a column depends on them.
        dependent: f64 = 1e-13, unit "", source "set by hand";
        /// The same for two columns.
        dependent_pair: f64 = 1e-12, unit "", source "set by hand";
        /// Squared residual that inner products leave by rounding.
        product_rounding: f64 = 1e-13, unit "of a unit column", source "set by hand, above the 1e-16 of one product";
        /// Residual of a subset of the columns up to which the other columns are superfluous.
        superfluous: f64 = 1e6, unit "residuals", source "set by hand";
    }
}

family! {
    /// Linear relations between signals, whether or not the library has the terms.
    pub(crate) SIGNAL_RELATIONS: SignalRelations {
        /// Signals that are compared.
        max_signals: usize = 14, unit "signals", source "set by hand";
        /// Rows below which no relation is sought.
        min_rows: usize = 4, unit "for each signal", source "set by hand";
        /// Constant from which a relation has one.
        constant: f64 = 10.0, unit "standard errors", source "set by hand";
        /// Constant that is rounding.
        constant_rounding: f64 = 1e-9, unit "of the summands", source "set by hand";
        /// Residual that rounded weights may leave, where the noise allows it.
        rounded_weights: f64 = 3e-3, unit "of the largest variation", source "set by hand";
        /// Growth of the residual that rounded weights may always cause.
        rounding_growth: f64 = 3.0, unit "residuals", source "set by hand";
    }
}

family! {
    /// The numerical rank of the columns, and when it is taken from the columns themselves.
    pub(crate) RANK: DesignRank {
        /// Singular values that count as zero where only inner products of the columns are known.
        product_tolerance: f64 = 1e-7, unit "of the largest", source "set by hand; inner products determine singular values to the root of machine epsilon, 1.5e-8";
        /// The same where the columns are factorised.
        column_tolerance: f64 = 1e-10, unit "of the largest", source "set by hand";
        /// Multiplications that a factorisation of the columns may take.
        factorisation: usize = 300_000_000, unit "multiplications", source "set by hand";
        /// Multiplications from which inner products take two threads.
        two_threads: usize = 20_000_000, unit "multiplications", source "set by hand";
    }
}

family! {
    /// The Monte Carlo estimate of the restricted isometry constants.
    pub(crate) RESTRICTED_ISOMETRY: RestrictedIsometry {
        /// Random supports with random coefficients.
        draws: usize = 1000, unit "supports", source "set by hand";
        /// Supports of which the singular values are computed as well.
        singular_value_draws: usize = 200, unit "supports", source "set by hand";
    }
}

family! {
    /// The search for other supports that fit as well; they tie as TermSelectionLimits.tie has it.
    pub(crate) EQUIVALENT_SUPPORTS: EquivalentSupports {
        /// Supports after which the search ends.
        max_supports: usize = 60, unit "supports", source "set by hand";
        /// Columns that are fitted in place of each term.
        fits: usize = 12, unit "columns", source "set by hand";
        /// Rounding of squared lengths from inner products.
        rounding: f64 = 1e-12, unit "of the squared length", source "set by hand";
    }
}

family! {
    /// Whether a relation between columns holds for values that were not measured.
    pub(crate) RELATION_IDENTITY: RelationIdentity {
        /// Random points.
        points: usize = 60, unit "points", source "set by hand";
        /// Sizes of the random values, tried in turn until all terms are finite.
        sizes: [f64; 2] = [3.0, 0.3], unit "of the largest value, plus one", source "set by hand";
        /// Residual below which the relation holds at the points.
        residual_growth: f64 = 10.0, unit "of Collinearity.exact", source "set by hand";
    }
}

family! {
    /// What a library lacks if its terms do not explain the target.
    pub(crate) MISSPECIFICATION: MisspecificationThresholds {
        /// Rows that are used.
        max_rows: usize = 1500, unit "rows", source "set by hand";
        /// Library whose whole span is projected out.
        span_terms: usize = 150, unit "terms", source "set by hand";
        /// Rows for each term of that library.
        span_rows: usize = 3, unit "rows", source "set by hand";
        /// Residual below which nothing is missing.
        negligible: f64 = 1e-4, unit "of the target", source "set by hand";
        /// The same, in terms of the noise.
        noise: f64 = 3.0, unit "of the noise", source "set by hand";
        /// Signals that simple terms are made of.
        signals: usize = 8, unit "signals", source "set by hand";
        /// Squared length off the library's span below which a term lies in it.
        dependent: f64 = 1e-16, unit "of the squared length", source "set by hand";
        /// Part of the remaining residual by which a term has to do better than a simpler one.
        complexity: f64 = 1e-2, unit "of the squared residual", source "set by hand";
        /// Factor by which a missing term lowers the residual beyond the noise.
        improvement: f64 = 4.0, unit "", source "set by hand";
        /// Least squared residual beyond the noise that the improvement is measured against.
        least_residual: f64 = 1e-3, unit "of the squared residual", source "set by hand";
        /// Residual of a lower derivative as a function of the other terms that indicates a lower order.
        lower_order: f64 = 1e-3, unit "of the derivative", source "set by hand";
        /// The same in terms of the error of the derivative.
        lower_order_noise: f64 = 3.0, unit "of the error", source "set by hand";
        /// Upper bound of that residual, however large the error.
        max_lower_order: f64 = 0.15, unit "of the derivative", source "set by hand";
        /// Rows for each term of that function.
        lower_order_rows: usize = 10, unit "rows", source "set by hand";
        /// Residual of the target's derivative as a function of the library and the target that indicates a higher order.
        higher_order: f64 = 0.15, unit "of the derivative", source "set by hand";
        /// The same in terms of the error of the derivative.
        higher_order_noise: f64 = 2.0, unit "of the error", source "set by hand";
        /// Upper bound of that residual, however large the error.
        max_higher_order: f64 = 0.4, unit "of the derivative", source "set by hand";
        /// Rows for each term of that function.
        higher_order_rows: usize = 3, unit "rows", source "set by hand";
        /// Signals whose products with the target take part in it.
        higher_order_signals: usize = 4, unit "signals", source "set by hand";
    }
}

family! {
    /// When the residual of a measured target is motion, which another method would leave unexplained, too.
    pub(crate) UNEXPLAINED_MOTION: UnexplainedMotion {
        /// White noise in it, at most.
        noise: f64 = 0.3333333333333333, unit "of its root mean square", source "eight ninths of its square are motion then, and no noise of sensors explains it";
        /// Largest library.
        max_terms: usize = 500, unit "terms", source "set by hand";
        /// Rows that are used.
        max_rows: usize = 3000, unit "rows", source "set by hand";
        /// Rows for each term, at least.
        rows: usize = 2, unit "rows", source "half the noise of a target is left then, whatever the terms";
    }
}

family! {
    /// A series that comes near a law which the library lacks, on data almost without error.
    pub(crate) SERIES: SeriesOfLaw {
        /// Residual that one missing term of the law leaves.
        left: f64 = 0.01, unit "of the residual without it", source "the errors of Runge-Kutta solvers along 120 random orbits are lowered by no standard term to less than a tenth";
        /// Squared length off the span of the support below which a term lies in it.
        dependent: f64 = 1e-28, unit "of the squared length", source "orthogonalising twice leaves rounding of 1e-15";
    }
}

family! {
    /// The experiment that would distinguish two terms, by trying changed signals.
    pub(crate) EXPERIMENT: ExperimentAdvice {
        /// Difference that the experiment has to show.
        difference: f64 = 5.0, unit "standard errors", source "set by hand";
        /// The same, at least, for clean data.
        clean_difference: f64 = 0.01, unit "of the target", source "set by hand";
        /// Rows that are changed.
        max_rows: usize = 800, unit "rows", source "set by hand";
        /// Sizes of the change that are tried.
        steps: i32 = 60, unit "sizes", source "set by hand";
        /// One size over the one before.
        ratio: f64 = 1.15, unit "", source "five sizes a doubling";
        /// First size of a change of sign, a step or a perturbation.
        first_size: f64 = 0.02, unit "of the signal", source "set by hand";
        /// Rows for which a random perturbation keeps its sign.
        hold: usize = 10, unit "rows", source "set by hand";
    }
}

family! {
    /// What the record did: spectra of its signals, and the rows that determine a coefficient.
    pub(crate) EXCITATION: ExcitationThresholds {
        /// Difference of time steps that still count as even.
        even_steps: f64 = 1e-3, unit "of the step", source "set by hand";
        /// Samples of a periodogram; longer records are averaged in groups.
        max_samples: usize = 4096, unit "samples", source "set by hand";
        /// Samples below which there is no periodogram.
        min_samples: usize = 32, unit "samples", source "sixteen frequencies: of fewer none is a band";
        /// Share of the power in the band.
        band_power: f64 = 0.95, unit "of the power", source "what is left of a smooth spectrum beyond is noise";
        /// Share of the rows whose leverage is reported.
        influential_rows: f64 = 0.01, unit "of the rows", source "set by hand";
        /// Length off the other columns of the support below which a column depends on them.
        dependent: f64 = 1e-12, unit "of a unit column", source "set by hand";
    }
}

family! {
    /// Findings about rows and coefficients. Doubts.uncertain decides which coefficients are.
    pub(crate) FINDINGS: FindingThresholds {
        /// Rows to choose k of N terms, over k ln N.
        rows_per_choice: f64 = 10.0, unit "", source "set by hand; the order k ln N is that of Candès & Wakin 2008";
        /// Rows that are advised at most.
        max_rows_per_term: usize = 3, unit "for each candidate", source "set by hand";
        /// Standard error that an uncertain coefficient should fall to.
        wanted_error: f64 = 0.1, unit "of the coefficient", source "set by hand";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![
        ListedIdentifiability::table(),
        Collinearity::table(),
        NullVectorLimits::table(),
        SignalRelations::table(),
        DesignRank::table(),
        RestrictedIsometry::table(),
        EquivalentSupports::table(),
        RelationIdentity::table(),
        SeriesOfLaw::table(),
        MisspecificationThresholds::table(),
        UnexplainedMotion::table(),
        ExperimentAdvice::table(),
        ExcitationThresholds::table(),
        FindingThresholds::table(),
    ]
}
