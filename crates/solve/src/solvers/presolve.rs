//! Presolve: problems whose answer needs no iteration.

use crate::linalg::norm;
use crate::problem::{Problem, Solution, Status};

/// ‖y‖₂, or the solution where no iteration is needed: a value that is not finite, or a target within ε.
pub(super) fn presolve(problem: &Problem) -> Result<f64, Solution> {
    let target_norm = norm(problem.target);
    if !is_finite(problem, target_norm) {
        return Err(Solution::zero(problem, Status::broken_down()));
    }
    if target_norm <= problem.tolerance {
        return Err(Solution::zero(problem, Status::Solved));
    }
    Ok(target_norm)
}

/// Whether Φ, ε and ‖y‖ = `target_norm` are numbers.
pub(crate) fn is_finite(problem: &Problem, target_norm: f64) -> bool {
    target_norm.is_finite() && problem.tolerance.is_finite() && problem.dictionary.is_finite()
}
