//! Numbers that decide which columns of an equation are judged, and what counts as noise.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// Columns of an equation that are compared with each other after it was found.
    pub(crate) SCALED_DESIGN: ScaledDesignLimits {
        /// Libraries up to this size are compared as a whole.
        whole_library: usize = 1200, unit "terms", source "set by hand";
        /// Columns of a larger library that are compared for each term found: those with the largest cosines.
        columns_per_term: usize = 60, unit "columns", source "set by hand";
        /// The same for all terms found together.
        columns: usize = 300, unit "columns", source "set by hand";
        /// Part of a column that the columns before it must leave for it to count as independent.
        independence: f64 = 1e-13, unit "of the column", source "450 machine epsilons; set by hand, not measured";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![ScaledDesignLimits::table()]
}
