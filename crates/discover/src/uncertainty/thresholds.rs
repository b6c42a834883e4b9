//! Numbers that decide in the inference about terms.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// The blocks of rows on whose normal equations supports are compared.
    pub(crate) ROW_BLOCKS: RowBlocks {
        /// Blocks that the rows are cut into.
        blocks: usize = 20, unit "blocks", source "set by hand";
        /// Rows of a block, at least.
        min_rows: usize = 2, unit "rows", source "set by hand";
        /// Columns off the support that may replace a term.
        alternatives: usize = 50, unit "columns", source "docs/thresholds-study.csv: 50 and 100 give the same answers, and 50 takes half the time";
        /// Residual variance below which inner products, which carry half the digits of their columns, hold rounding only.
        rounding: f64 = 1e-9, unit "of the target's mean square", source "sums of 10^4 squares round by 1e-12; three digits of the variance are left";
    }
}

family! {
    /// Complementary pairs stability selection (Shah & Samworth 2013).
    pub(crate) STABILITY_SELECTION: StabilitySelection {
        /// Random divisions of the blocks into two halves.
        complementary_pairs: usize = 25, unit "pairs of halves", source "the frequency of a term among 50 halves has a standard error of 0.07; Shah & Samworth 2013 take 50 pairs";
        /// Blocks below which no halves are drawn.
        min_blocks: usize = 4, unit "blocks", source "two blocks in each half";
    }
}

family! {
    /// Whether a term equals a combination of others for all values of its signals.
    pub(crate) IDENTITY_TEST: IdentityTest {
        /// Random points at which both are compared.
        points: usize = 40, unit "points", source "set by hand";
        /// Terms of the combination.
        max_terms: usize = 12, unit "terms", source "a third of the points, so that a chance fit is impossible";
        /// Residual below which the two are equal.
        residual: f64 = 1e-9, unit "of the term", source "set by hand";
        /// Singular values below this count as zero.
        singular: f64 = 1e-12, unit "", source "set by hand";
        /// Ranges of the random values: of either sign, and where roots and logarithms are defined.
        ranges: [(f64, f64); 2] = [(-2.0, 2.0), (0.3, 2.0)], unit "", source "set by hand";
    }
}

family! {
    /// The omitted terms that come nearest to being selected.
    pub(crate) OMITTED_TERMS: OmittedTerms {
        /// Terms that are named.
        named: usize = 4, unit "terms", source "set by hand";
        /// Changes of the support that are compared.
        moves: usize = 8, unit "for each column", source "set by hand";
        /// Difference of gain below which two omitted terms do equally well, in parts of a tie.
        similar: f64 = 0.5, unit "of Marks.tied", source "set by hand";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![
        RowBlocks::table(),
        StabilitySelection::table(),
        IdentityTest::table(),
        OmittedTerms::table(),
    ]
}
