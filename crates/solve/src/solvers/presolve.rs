//! Presolve: problems whose answer needs no iteration.

use crate::linalg::norm;
use crate::problem::{Problem, Solution, Status};

/// ‖y‖₂, or the solution where no iteration is needed: a value that is not finite, or a target within ε.
pub(super) fn presolve(problem: &Problem) -> Result<f64, Solution> {
    let size = norm(problem.target);
    if !is_finite(problem, size) {
        return Err(Solution::zero(problem, Status::broken_down()));
    }
    if size <= problem.tolerance {
        return Err(Solution::zero(problem, Status::Solved));
    }
    Ok(size)
}

/// Whether Φ, ε and ‖y‖ = `size` are numbers.
pub(super) fn is_finite(problem: &Problem, size: f64) -> bool {
    let norms = problem.dictionary.norms();
    size.is_finite() && problem.tolerance.is_finite() && norms.iter().all(|n| n.is_finite())
}
