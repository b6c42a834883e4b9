//! Numbers that decide which other laws are looked for among the relations of coupled equations.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// The search, among linear combinations of multiples of the laws found, for laws of fewer terms.
    pub(crate) FEWER_TERMS: FewerTermsLimits {
        /// Residual of an equation up to which the search is made: in noise, terms of a sum cancel by chance.
        clean: f64 = 1e-5, unit "of the largest term", source "set by hand: laws of a solver with an error of 1e-6 count as exact, noisy ones do not";
        /// Part of its summands below which a coefficient of a sum is rounding.
        cancelled: f64 = 1e-9, unit "of the summands", source "set by hand: coefficients of exact laws have 10 digits or more";
        /// The same over the residual of the equations, where that is more.
        room: f64 = 10.0, unit "residuals", source "set by hand";
        /// Residual of a sum that is rounding.
        rounding: f64 = 1e-9, unit "of the largest term", source "set by hand";
        /// Degree of a multiplier, at most.
        degree: f64 = 3.0, unit "", source "set by hand: laws of mechanisms have terms of degree 4, and share a factor with others";
        /// Multiples of laws that take part, at most.
        multiples: usize = 120, unit "multiples", source "set by hand: elimination takes some tens of milliseconds";
        /// Terms of all multiples, at most.
        terms: usize = 600, unit "terms", source "set by hand: basis pursuit in a matrix of as many columns takes milliseconds";
        /// Sets of terms up to which all are visited.
        visited: usize = 20_000, unit "sets", source "set by hand: some tens of milliseconds";
        /// Terms for which basis pursuit solves the relations, at most.
        pins: usize = 40, unit "terms", source "set by hand";
        /// Part of a law's row of the mass matrix that must be across those of the others.
        independent: f64 = 1e-3, unit "of its length", source "set by hand";
        /// Condition of the mass matrix, over that of the equations found, up to which laws are said.
        condition: f64 = 3.0, unit "times", source "set by hand";
    }
}

family! {
    /// Which equation gives which highest derivative.
    pub(crate) TARGETS: TargetLimits {
        /// Factor in the condition number from which another assignment is said.
        better: f64 = 3.0, unit "times", source "set by hand: half a digit of the accelerations";
        /// Coefficient of a highest derivative, on every row, by which a law may be divided.
        divisor: f64 = 0.05, unit "of its rms", source "set by hand: it must not cross zero";
        /// Equations up to which all assignments are compared.
        all: usize = 5, unit "equations", source "120 assignments on 200 rows are a tenth of a second";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![FewerTermsLimits::table(), TargetLimits::table()]
}
