//! Numbers that decide what a verification confirms, and how it is computed.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// How far the figures of a verification may be from what is claimed. The limits of a certificate are those that its claims are made with;
    /// they are stated a second time because a verification shares nothing with what it checks.
    pub(crate) VERIFICATION: VerificationTolerances {
        /// Distance of a coefficient from the least-squares one.
        coefficient: f64 = 1e-6, unit "of the coefficient", source "set by hand";
        /// Rounding of a fit in f64 with orthogonal columns.
        fit_rounding: f64 = 1e-13, unit "of the largest term", source "450 machine epsilons; set by hand, not measured";
        /// Distance of the residual from the one that is stated.
        residual: f64 = 1e-3, unit "of the residual", source "set by hand";
        /// Rows of a fitted trajectory may miss the equation by this much, since its rates were solved for in f64.
        trajectory: f64 = 1e-9, unit "of the largest part", source "set by hand";
        /// Distance within which an instant of the trajectory is that of a late reading.
        instant: f64 = 1e-6, unit "sampling intervals", source "as the delay was applied";
        /// Distance of the residual of a sensor from the one that is stated.
        readings: f64 = 1e-6, unit "of the residual", source "set by hand";
        /// Duality gap up to which the 1-norm counts as the smallest.
        gap: f64 = 1e-6, unit "of the 1-norm", source "the limit of the certificates that are checked";
        /// Part of its 1-norm that any other minimiser may have off the support of a unique one.
        elsewhere: f64 = 1e-3, unit "of the 1-norm", source "the limit of the certificates that are checked";
        /// Residual beyond ε that counts as feasible.
        feasibility: f64 = 1e-6, unit "of ε, or of the target where ε is zero", source "the limit of the certificates that are checked";
        /// Distance of the largest correlation from the one that is stated.
        correlation: f64 = 1e-6, unit "", source "set by hand";
        /// Pivot of a unit column from which on it counts as independent of those before it.
        independence: f64 = 1e-11, unit "", source "set by hand, far above the square root of the rounding of a Gram matrix, √2⁻¹⁰² = 4e-16";
    }
}

family! {
    /// Where arithmetic in 106 bits and its error bounds hold.
    pub(crate) ARITHMETIC: VerifiedArithmetic {
        /// Size of a product below which its last digits leave the range of f64.
        underflow: f64 = 1e-290, unit "", source "the rounding of a product, 2⁻⁵³ of it, must be a normal number: above 2.2e-308";
        /// Length of a column below which it counts as zero.
        shortest_column: f64 = 1e-140, unit "", source "its square, 1e-280, stays above the limit of underflow by 1e10";
        /// Error of an argument up to which twice the first-order bound covers the change of a function.
        linearisation: f64 = 1e-3, unit "of the scale on which the slope changes", source "there terms of second order are a thousandth of the first; the factor of two covers them";
        /// Angle up to which quarter turns are taken off.
        angle: f64 = 1e15, unit "rad", source "the number of quarter turns, 6.4e14, is an integer that f64 holds exactly: below 2⁵³ = 9e15";
        /// Term of a Taylor series that ends it.
        series_end: f64 = 1e-36, unit "of the first term", source "a ten-thousandth of 2⁻¹⁰⁶ = 1.2e-32";
    }
}

family! {
    /// Sizes of the work between two looks at the observer, and in memory.
    pub(crate) TILES: VerificationTiles {
        /// Numbers of a tile of columns.
        numbers: usize = 130_000, unit "numbers", source "1 MB, which the cache of a core holds";
        /// Columns of a tile.
        columns: usize = 256, unit "columns", source "set by hand";
        /// Values of atoms that are kept for all rows.
        atom_bytes: usize = 64_000_000, unit "bytes", source "set by hand";
        /// Rows between two questions to the observer.
        observed_rows: usize = 256, unit "rows", source "set by hand";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![
        VerificationTolerances::table(),
        VerifiedArithmetic::table(),
        VerificationTiles::table(),
    ]
}
