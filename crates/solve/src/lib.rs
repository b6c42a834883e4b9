//! Sparse solvers: numbers in, numbers and a status out; no names, no files.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod certificates;
mod constrained;
pub mod dictionary;
mod least_squares;
pub mod linalg;
#[cfg(test)]
mod planted;
mod problem;
pub mod simd;
mod solver;
mod solvers;
mod sparsest;
mod statistics;
pub mod threads;
mod thresholds;

pub use certificates::{
    Certificate, LassoCertificate, certify, certify_lasso, certify_support, refine_dual, support,
};
pub use constrained::{
    ConstrainedCertificate, ConstrainedFit, ConstrainedProblem, ConstrainedSolution,
    LinearConstraint, Outcome, RegressionBlock, Sense, SolutionSpace, certify_constrained,
    constrained_least_squares, irreducible_infeasible_set, least_residuals, solution_space,
    solve_constrained,
};
pub use least_squares::{
    LeastSquares, QuadraticForm, Refit, SingleChange, minimum_norm_least_squares, refit,
};
pub use problem::{Problem, Solution, Status};
pub use solver::Solver;
pub use solvers::{
    Clarabel, Homotopy, Knot, Omp, SOLVERS, Stlsq, is_sparse, lasso, lasso_path, solver,
};
pub use sparsest::{Sparsest, SparsestLimits, fits, prove_sparsest};
pub use statistics::{
    Autoregression, WHITENESS_LAGS, WeightedSum, rms_autocorrelation, white_noise_bound,
};
pub use thresholds::{QUADRATIC_FORM, tables as thresholds};
