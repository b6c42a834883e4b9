//! Numbers from which evidence becomes a doubt.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// Doubts about unknown constants.
    pub(crate) CONSTANT_DOUBTS: ConstantDoubts {
        /// Change of a term within the standard error of its constant above which the data hardly tell the constant.
        change: f64 = 0.5, unit "of the term", source "a 95 % interval is two standard errors to each side: the term may then be absent, or twice as large";
        /// Distance from a whole number below which a power is that number.
        whole_power: f64 = 0.1, unit "", source "set by hand: powers are computed along a curved valley";
        /// Distance from an end of its range at which a constant lies there.
        at_end: f64 = 1e-6, unit "of the constant", source "steps are cut off at the end exactly; printing rounds";
    }
}

family! {
    /// Doubts of an equation from rows, and those that both methods share.
    pub(crate) DOUBTS: Doubts {
        /// Residual above which too much of the target is left unexplained.
        poor_fit: f64 = 0.1, unit "of the target", source "a hundredth of the variance";
        /// Residual above which a term is missing.
        misfit: f64 = 5.0, unit "of the error of the data", source "two and a half standard deviations of an error that is known to a factor of two";
        /// Estimated error of a derivative above which it is hardly known.
        rough_target: f64 = 0.1, unit "of the target", source "set by hand";
        /// Residual below which rounding decides, and no misfit is seen.
        negligible_residual: f64 = 1e-9, unit "of the target", source "the least tolerance of a fit, TOLERANCE.relative_floor";
        /// Residual up to which the integration error of simulated data explains it, unless a missing term does.
        solver_residual: f64 = 1e-6, unit "of the target", source "Runge-Kutta of order 4 with steps of a quarter sample leaves 1e-10 to 3e-8 along 40 random orbits, solvers with tolerances of 1e-8 as much";
        /// Residual that a few rows alone may cause, since their errors are known to a factor only; above the error of the data it is a
        /// misfit only if the median row is missed, too.
        small_residual: f64 = 1e-4, unit "of the target", source "attack cases: exact laws with switches leave up to 6e-5 by few rows, a series of a law 2e-9 and more by all";
        /// Residual above which data count as noisy.
        noisy: f64 = 1e-6, unit "of the target", source "set by hand";
        /// Autocorrelation of residuals that matters, however certain it is.
        autocorrelation: f64 = 0.05, unit "", source "set by hand";
        /// Held-out residual above which an equation does not carry over.
        overfit: f64 = 2.0, unit "of the residual in the fit", source "set by hand";
        /// Least residual that held-out rows are compared with.
        held_out_rounding: f64 = 1e-7, unit "of the target", source "set by hand";
        /// Noisy rows for each term below which another law may fit by chance.
        rows_per_term: usize = 15, unit "rows or readings", source "10 to 20 observations for each candidate (Harrell, Regression Modeling Strategies, 4.4)";
        /// Rows for each term below which a law is not sparse.
        sparse_rows: usize = 3, unit "rows", source "set by hand";
        /// Standard error above which a term could as well be absent.
        uncertain: f64 = 0.3, unit "of the coefficient", source "set by hand";
        /// Condition number of the unit columns above which a support is numerically dependent.
        condition: f64 = 1e8, unit "", source "set by hand";
        /// Library of which a law that uses all is doubted.
        exhausted_terms: usize = 4, unit "terms", source "set by hand";
        /// Library of which a law that uses more than half is doubted.
        half_used_terms: usize = 10, unit "terms", source "set by hand";
    }
}

family! {
    /// Single rows that an equation misses.
    pub(crate) BADLY_FITTED_ROWS: BadlyFitted {
        /// Miss of a row that matters.
        large: f64 = 0.5, unit "of the target", source "set by hand";
        /// Miss of a row that errors of the estimated size do not explain.
        certain: f64 = 10.0, unit "errors of the row", source "set by hand";
        /// Pairs of successive rows below which autocorrelation is not judged.
        min_neighbours: usize = 50, unit "pairs of rows", source "set by hand";
    }
}

family! {
    /// Linear relations between the states.
    pub(crate) DEPENDENT_STATES: DependentStates {
        /// Variance below which a combination of states is constant; the noise itself is known to some 5 %.
        constant: f64 = 1.15, unit "variances of the noise", source "three standard errors of a variance known to 5 %";
        /// Noise of data that have none.
        clean_noise: f64 = 1e-7, unit "of the spread", source "set by hand";
        /// Contribution from which a state is named.
        named: f64 = 0.02, unit "of the largest contribution", source "set by hand";
    }
}

family! {
    /// Doubts of equations that were estimated with their trajectory.
    pub(crate) TRAJECTORY_DOUBTS: TrajectoryDoubts {
        /// Residual above which little is explained, where it is more than noise.
        poor_fit: f64 = 0.3, unit "of the spread", source "a tenth of the variance";
        /// The same where it is white and of the size of the sensor's noise.
        mostly_noise: f64 = 0.7, unit "of the spread", source "half of the variance is noise";
        /// Residual above which something is missing.
        misfit: f64 = 1.25, unit "of the sensor's noise", source "the noise of 50 readings is known to a tenth, 1/√(2 · 50); two and a half of that";
        /// Residual below which what is left is rounding.
        negligible_residual: f64 = 1e-6, unit "of the spread", source "set by hand";
        /// Terms beyond the library that a doubt names; more of them imitate a law as a series does, and are not worth adding.
        named_terms: usize = 3, unit "terms", source "attack cases: a term left out comes back as one, or as three at most";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![
        ConstantDoubts::table(),
        Doubts::table(),
        BadlyFitted::table(),
        DependentStates::table(),
        TrajectoryDoubts::table(),
    ]
}
