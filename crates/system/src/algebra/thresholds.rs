//! Numbers that decide what is solved in symbols, and what counts as zero near a point.

use sidc_thresholds::Table;

sidc_thresholds::family! {
    /// Linearization at a point.
    pub LINEARIZATION: Linearization {
        /// Condition number of M, rows scaled, from which it is singular.
        singular: f64 = 1e12, unit "", source "set by hand";
        /// Largest rate that is rounding of an equilibrium.
        at_rest: f64 = 1e-12, unit "of the terms of the sum", source "set by hand";
        /// Largest slope that is rounding.
        cancelled: f64 = 1e-15, unit "of what was added", source "a few times the unit roundoff of 1.1e-16";
        /// Change of the point that a slope has to survive.
        nudge: f64 = 4.0 * f64::EPSILON, unit "of each value", source "a few units in the last place";
        /// Newton steps towards inputs that hold the point.
        newton_steps: usize = 20, unit "steps", source "set by hand";
        /// Rotations that a singular value decomposition may take.
        svd_iterations: usize = 10_000, unit "rotations", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// Eigenvalues and controllability.
    pub EIGENVALUES: Eigenvalues {
        /// Distance within which eigenvalues are replaced by their mean.
        cluster: f64 = 1e-7, unit "of the norm of A", source "rounding moves a double eigenvalue by the square root of the unit roundoff, 1e-8 (Golub and Van Loan, Matrix Computations, 7.2)";
        /// Most steps of the QR algorithm for each eigenvalue.
        qr_steps: usize = 100, unit "steps", source "LAPACK's dhseqr takes at most 30 (Anderson et al. 1999); three times that";
        /// Real or imaginary part that is zero.
        rounding: f64 = 1e-12, unit "of the norm of A", source "set by hand";
        /// Part of a vector, orthogonal to the directions reached before, that counts as a new one.
        new_direction: f64 = 1e-9, unit "of the vector", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// Kinks: places without a derivative.
    pub KINKS: Kinks {
        /// Distance that counts as none.
        at_kink: f64 = 1e-12, unit "of the larger of 1 and the value", source "set by hand";
        /// Kinks that are looked at.
        listed: usize = 16, unit "kinks", source "set by hand";
        /// Difference of two sides that is more than rounding.
        sides_differ: f64 = 1e-9, unit "relative", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// Solutions in symbols.
    pub SYMBOLIC: Symbolic {
        /// Unknowns that Cramer's rule is applied to together.
        largest_tie: usize = 3, unit "unknowns", source "set by hand";
        /// Terms of all numerators and the longest denominator, for a solution to be printed.
        longest: usize = 40, unit "terms", source "set by hand";
        /// Terms before merging that an expansion may have: a bound on time and memory.
        expanded_terms: usize = 20_000, unit "terms", source "set by hand";
        /// Highest power of a sum that is multiplied out.
        expanded_power: f64 = 64.0, unit "", source "set by hand";
        /// Weight of a merged term that is rounding.
        cancelled: f64 = 1e-13, unit "of what was added", source "set by hand";
        /// Highest power of sin² or cos² that is rewritten: (1 - c²)⁸ has 9 terms.
        rewritten_square: u32 = 8, unit "", source "set by hand";
        /// Rounds of clearing fractions inside fractions.
        clearing_rounds: usize = 8, unit "rounds", source "set by hand";
    }
}

/// Every family of this module.
pub fn tables() -> Vec<Table> {
    vec![
        Linearization::table(),
        Eigenvalues::table(),
        Kinks::table(),
        Symbolic::table(),
    ]
}
