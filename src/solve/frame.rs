//! What every solver does around its own iterations: reduce, settle the cases that need none, tell misfit from inaccuracy.
//!
//! In: a [`Problem`] and the iterations on its reduced form. Out: a [`Solution`] with an honest status.

use super::least_squares::inconsistent;
use super::reduce::Reduced;
use super::{Problem, Solution, Status};

/// Runs `iterate` on the reduced problem and its ε; `None` from it means that nothing usable was reached.
pub(super) fn solve_reduced(
    problem: &Problem,
    iterate: impl FnOnce(&Reduced, f64) -> Option<Solution>,
) -> Solution {
    let Some(reduced) = Reduced::new(problem) else {
        return Solution::zero(problem, Status::broken());
    };
    if reduced.size <= problem.tolerance {
        return Solution::zero(problem, Status::Solved);
    }
    let Some(tolerance) = reduced
        .inner_tolerance()
        .filter(|_| !reduced.strengths.is_empty())
    else {
        let residual = f64::INFINITY;
        return inconsistent(
            problem,
            Solution::zero(problem, Status::Inconsistent { residual }),
        );
    };
    let Some(solution) = iterate(&reduced, tolerance) else {
        return Solution::zero(problem, Status::broken());
    };
    match solution.status {
        Status::Inaccurate { .. } => inconsistent(problem, solution),
        _ => solution,
    }
}
