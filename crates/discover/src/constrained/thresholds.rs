//! Numbers that decide where constraints tie coefficients.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// Checks of constraints.
    pub(crate) CONSTRAINTS: Constraints {
        /// Constraints that share coefficients: the check for contradictions takes time with the cube of their number.
        max_coupled: usize = 200, unit "constraints", source "set by hand";
        /// Contradictions that are reported.
        max_conflicts: usize = 10, unit "conflicts", source "set by hand";
        /// Miss of an equality that is rounding, in a solution.
        solved_rounding: f64 = 1e-12, unit "of the largest summand", source "set by hand";
        /// Miss of a constraint that is rounding, in the result.
        reported_rounding: f64 = 1e-9, unit "of the largest summand", source "set by hand";
    }
}

family! {
    /// The search over supports under constraints.
    pub(crate) CONSTRAINED_SEARCH: ConstrainedSearchLimits {
        /// Additions tried for every place of a support.
        additions: usize = 5, unit "columns", source "set by hand";
        /// Moves of one descent.
        max_moves: usize = 60, unit "moves", source "set by hand";
    }
}

family! {
    /// When data contradict constraints, or pull against them.
    pub(crate) DATA_CONFLICT: DataConflict {
        /// Squared deviation that true constraints do not reach.
        impossible: f64 = 30.0, unit "squared standard errors", source "set by hand";
        /// Residual that rounding may leave.
        numerical: f64 = 1e-6, unit "of the target", source "set by hand";
        /// Distance between the data and a constraint that chance does not explain.
        strained: f64 = 5.0, unit "standard errors", source "set by hand";
        /// Distance that is not reported more closely.
        far: f64 = 1000.0, unit "standard errors", source "set by hand";
    }
}

family! {
    /// What counts as proved of a constrained answer.
    pub(crate) JOINT_CERTIFICATE: JointCertificateLimits {
        /// Residual beyond ε that counts as within it.
        within_tolerance: f64 = 1e-6, unit "of ε", source "set by hand";
        /// Share that another minimiser may have off the support, for uniqueness.
        elsewhere: f64 = 1e-3, unit "of the ℓ1 norm", source "set by hand";
        /// Share below which a coefficient is the conic solver's rounding.
        negligible_share: f64 = 1e-6, unit "of the largest |a|‖φ‖", source "set by hand";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![
        Constraints::table(),
        ConstrainedSearchLimits::table(),
        DataConflict::table(),
        JointCertificateLimits::table(),
    ]
}
