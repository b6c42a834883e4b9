//! Numbers that decide where the rows of a large table are reduced.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// Rows reduced to a triangular factor, part by part.
    pub(crate) ROW_REDUCTION: RowReduction {
        /// Rows factorised at a time: with some tens of terms they fit in the cache of a core.
        block_rows: usize = 2048, unit "rows", source "set by hand";
        /// The same in candidate terms, where these are many, so that the factor above the rows costs little.
        blocks_of_terms: usize = 8, unit "terms", source "set by hand";
        /// How far from its value on the rows looked at closely, in half widths of its interval, a coefficient of all rows may lie: four standard errors.
        drift: f64 = 2.0, unit "half widths", source "1 in 16,000 of independent estimates lies farther";
        /// Difference of coefficients that is rounding.
        rounding: f64 = 1e-8, unit "of the coefficient", source "set by hand";
    }
}

/// The tables of this folder.
pub(crate) fn tables() -> Vec<Table> {
    vec![RowReduction::table()]
}
