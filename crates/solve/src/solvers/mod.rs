//! The solvers of basis pursuit, one file or folder each, and what they share.

mod clarabel;
mod column_generation;
mod homotopy;
mod infeasibility;
mod omp;
mod presolve;
mod range_reduction;
mod stlsq;

use crate::solver::Solver;

pub use clarabel::Clarabel;
pub use homotopy::{Homotopy, Knot, is_sparse, lasso, lasso_path};
pub use omp::Omp;
pub(crate) use presolve::is_finite;
pub use stlsq::Stlsq;

/// Every solver; the first is the default, heuristics come last.
pub static SOLVERS: &[&dyn Solver] = &[&Homotopy, &Clarabel, &Omp, &Stlsq];

/// Looks a solver up by name.
///
/// ```
/// use sidc_solve::dictionary::Dense;
/// use sidc_progress::Unwatched;
/// use sidc_solve::{Problem, solver};
///
/// // Columns (1, 0, 0), (0, 1, 0) and (1, 1, 1): the target is twice the last.
/// let phi = Dense::new(3, vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0]);
/// let problem = Problem { dictionary: &phi, target: &[2.0, 2.0, 2.0], tolerance: 0.0 };
/// for name in ["homotopy", "clarabel", "omp"] {
///     let found = solver(name).map(|s| s.solve(&problem, &mut Unwatched));
///     assert!(found.is_some_and(|s| (s.coefficient(2) - 2.0).abs() < 1e-6));
/// }
/// assert!(solver("magic").is_none());
/// ```
pub fn solver(name: &str) -> Option<&'static dyn Solver> {
    SOLVERS.iter().copied().find(|s| s.name() == name)
}
