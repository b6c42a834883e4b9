//! Several problems whose coefficients are tied by linear constraints: basis pursuit as one conic program, least squares on a
//! support, certificates, and constraints that contradict each other.

mod certificate;
mod column_generation;
mod conic_program;
mod elimination;
mod infeasible_set;
mod least_distance;
mod least_squares;
mod problem;

pub use certificate::{ConstrainedCertificate, certify_constrained};
pub use column_generation::{least_residuals, solve_constrained};
pub use elimination::{SolutionSpace, solution_space};
pub use infeasible_set::irreducible_infeasible_set;
pub use least_squares::{ConstrainedFit, RegressionBlock, constrained_least_squares};
pub use problem::{ConstrainedProblem, ConstrainedSolution, LinearConstraint, Outcome, Sense};
