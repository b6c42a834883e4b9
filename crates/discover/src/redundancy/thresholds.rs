//! Numbers that decide whether coupled equations are one relation.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// When one equation is another one rearranged.
    pub(crate) REDUNDANCY: Redundancy {
        /// Condition of the mass matrix of two equations from which they may be one relation.
        close: f64 = 10.0, unit "condition number", source "set by hand";
        /// Condition from which hardly anything of the highest derivatives is left between them.
        singular: f64 = 1e3, unit "condition number", source "set by hand";
        /// Part of its gradient by which a relation may differ from a copy.
        alike: f64 = 0.2, unit "of the gradient", source "set by hand";
        /// Difference of two relations, over their uncertainty, from which they count as different.
        certain: f64 = 5.0, unit "of the uncertainty", source "set by hand";
        /// Part of the gradient that is rounding and small errors of derivatives.
        rounding: f64 = 1e-5, unit "of the gradient", source "set by hand";
        /// Rows on which gradients are compared.
        sampled_rows: usize = 200, unit "rows", source "set by hand";
    }
}

family! {
    /// The search for a law that is independent of the other equations, and when it replaces a copy.
    pub(crate) INDEPENDENT_LAW: IndependentLawLimits {
        /// Condition up to which a law is independent: errors are a tenth of the size of a relation, and more.
        condition: f64 = 30.0, unit "condition number", source "set by hand";
        /// Residual up to which an independent law replaces the copy.
        bearable: f64 = 1.5, unit "of the residual of the copy", source "set by hand";
        /// Growth of the residual, where the system is solved, up to which no large part of a law may be the copy.
        growth: f64 = 2.0, unit "", source "set by hand";
        /// Residual from which it is plain which equation is the copy.
        rougher: f64 = 2.0, unit "of the other residuals", source "set by hand";
        /// Residual that is rounding.
        exact: f64 = 1e-9, unit "of the target", source "set by hand";
        /// Price of having no independent law: more than any law costs.
        no_law_price: f64 = 1e6, unit "of the criterion, each row", source "any number above all prices";
        /// Supports that are visited, over the columns of a pool: about a second.
        work: usize = 4000, unit "supports times columns", source "set by hand";
        /// Supports that are visited, at least.
        min_supports: usize = 8, unit "supports", source "set by hand";
        /// Supports that are visited, at most.
        max_supports: usize = 60, unit "supports", source "set by hand";
        /// Library of which the simplest terms are still looked up.
        listed_terms: usize = 100_000, unit "terms", source "set by hand";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![Redundancy::table(), IndependentLawLimits::table()]
}
