//! The numbers that decide what a first model looks like.

sidc_thresholds::family! {
    /// What the columns of a table are taken for, and how large a first model gets.
    pub(crate) DRAFT: DraftThresholds {
        /// Most columns: every pair of them is compared, and a longer draft would not be read.
        max_columns: usize = 100, unit "columns", source "set by hand";
        /// Most candidate terms of one equation, so that a first search is quick.
        max_candidate_terms: usize = 80, unit "terms", source "a search of that many takes a second or so on noisy readings; half leaves out products that a cart and a motor need";
        /// The same of coupled bodies whose accelerations were measured.
        max_coupled_terms: usize = 300, unit "terms", source "the cart with a double pendulum has 207 with products of two rates, and its law in 0.4 s";
        /// Rows for each of these.
        rows_a_term: usize = 2, unit "rows", source "half the noise of a target is left then, whatever the terms";
        /// Fewest differences by which a column may be held between samples.
        min_differences: usize = 10, unit "differences", source "set by hand";
        /// Range of a column, relative to its size, that is constant.
        constant: f64 = 1e-12, unit "", source "set by hand";
        /// Jump of an angle that wraps.
        wrapped_step: f64 = 0.75, unit "turns", source "a jump of three quarters of a turn back is a quarter forth: angles sampled four times a turn are told";
        /// Largest range of an angle that wraps.
        wrapped_range: f64 = 1.001, unit "turns", source "a turn, and its rounding";
    }
}

sidc_thresholds::family! {
    /// When a column is the rate of another.
    pub(crate) RATE: RateThresholds {
        /// Rms of the slope that the rate may leave unexplained.
        unexplained: f64 = 0.15, unit "of the slope's rms", source "set by hand";
        /// Deviation of a measured factor from a ratio of units.
        unit_tolerance: f64 = 0.02, unit "of the ratio", source "2π/60 and 0.1 are 5 % apart";
        /// Fewest rows that are compared.
        min_rows: usize = 20, unit "rows", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// Whether the law of a state is of first or of second order.
    pub(crate) LAW_ORDER: LawOrderThresholds {
        /// Part of the variance of the rate that the other signals explain if the law is of first order.
        explained: f64 = 0.6, unit "of the variance", source "experiment: orders_are_guessed_from_positions in tests/it/drafts.rs, which says what it misses";
        /// Rows that are looked at.
        max_rows: usize = 1500, unit "rows", source "set by hand";
        /// Signals whose products are tried.
        max_signals: usize = 8, unit "signals", source "set by hand";
        /// Movement over one difference, in the mean, that is visible in noise.
        visible: f64 = 0.05, unit "standard deviations", source "set by hand";
        /// The same, in terms of the noise of the samples.
        visible_noise: f64 = 4.0, unit "standard deviations of the noise", source "experiment: orders_are_guessed_from_positions in tests/it/drafts.rs; 8 blurs fast motion";
        /// Fewest rows beyond the two ends.
        min_rows: usize = 30, unit "rows", source "set by hand";
        /// Singular values below this are zero.
        rank_tolerance: f64 = 1e-9, unit "", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// When a column is driven from outside, and when it says nothing of its own.
    pub(crate) EXOGENEITY: ExogeneityThresholds {
        /// Least part of a step's variance that the column's own past leaves unexplained.
        alone: f64 = 0.5, unit "of the variance", source "experiment: inputs_are_known_by_their_values in tests/it/drafts.rs; more of it is news than not";
        /// What the past of the others must leave of that; and what the column may leave of a step that it moves.
        others: f64 = 0.9, unit "of the variance", source "experiment: inputs_are_known_by_their_values in tests/it/drafts.rs";
        /// What a combination of other columns leaves of a column.
        combination: f64 = 1e-6, unit "of its length", source "tables with six digits; laws hold so well only between columns computed from each other";
        /// Fewest rows for each column of a combination.
        rows_a_column: usize = 10, unit "rows", source "set by hand: with few rows any column is a combination";
    }
}
