//! Numbers that decide in the selection of terms.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// Which columns take part in a selection, and when two supports are equally good.
    pub(crate) TERM_SELECTION: TermSelectionLimits {
        /// Candidates up to which all take part; beyond, only the solver's proposals.
        exhaustive_columns: usize = 400, unit "columns", source "set by hand";
        /// Proposals of a solver that take part.
        max_proposals: usize = 80, unit "columns", source "set by hand";
        /// Terms of one equation.
        max_terms: usize = 40, unit "terms", source "set by hand";
        /// Share below which a coefficient is the solver's rounding.
        negligible_share: f64 = 1e-7, unit "of the largest |a|‖φ‖", source "set by hand";
        /// Difference below which two supports are a tie: odds of e³ to 1.
        tie: f64 = 6.0, unit "of the criterion", source "Kass & Raftery 1995, section 3.2: 6 is strong evidence";
    }
}

family! {
    /// The best-subset search: a beam, then single changes.
    pub(crate) SUBSET_SEARCH: SubsetSearch {
        /// Subsets kept at each size.
        beam_width: usize = 8, unit "subsets", source "set by hand";
        /// Sizes without improvement after which the beam ends.
        beam_patience: usize = 4, unit "sizes", source "set by hand";
        /// Additions tried for every place of the support.
        additions: usize = 3, unit "columns", source "set by hand";
        /// Length off the chosen columns below which a column is dependent on them.
        dependent: f64 = 1e-9, unit "of a unit column", source "set by hand";
        /// Improvement below which the descent ends.
        least_gain: f64 = 1e-9, unit "of the criterion", source "set by hand";
    }
}

family! {
    /// Which columns of a large library take part in the joint estimate.
    pub(crate) SCREENING: Screening {
        /// Columns of all laws together that are searched whole.
        searched_columns: usize = 520, unit "columns", source "set by hand";
        /// Library that is never cut.
        small_library: usize = 60, unit "terms", source "set by hand";
        /// Columns proposed for each law.
        max_proposals: usize = 30, unit "columns", source "set by hand";
        /// Knots of the path that are looked at.
        max_knots: usize = 120, unit "knots", source "set by hand";
        /// Error of the laws before anything is known of them.
        slack: f64 = 0.1, unit "of the sensors' noise", source "set by hand";
        /// Work of all sketches together, about a minute.
        max_work: f64 = 1e11, unit "products", source "set by hand";
        /// Entries of a sketch.
        max_sketch_entries: usize = 16_000_000, unit "numbers", source "set by hand";
        /// Rows of a sketch, at least.
        min_sketch_rows: usize = 300, unit "rows", source "set by hand";
        /// Rows of a sketch, at most.
        max_sketch_rows: usize = 2000, unit "rows", source "set by hand";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![
        TermSelectionLimits::table(),
        SubsetSearch::table(),
        Screening::table(),
    ]
}
