//! What every solver does around its own iterations: reduce, settle the cases that need none, tell misfit from inaccuracy.
//!
//! In: a [`Problem`] and the iterations on its reduced form. Out: a [`Solution`] with an honest status.

use super::least_squares::inconsistent;
use super::reduce::{Reduced, norm};
use super::working_set::grow;
use super::{Problem, Solution, Status};

/// Most entries of Φ that are put side by side, 40 MB; beyond, a working set grows.
const WHOLE: usize = 5_000_000;

/// ‖y‖₂, or the solution where no iteration is needed: a value that is not finite, or a target within ε.
pub(super) fn settle(problem: &Problem) -> Result<f64, Solution> {
    let size = norm(problem.target);
    if !is_finite(problem, size) {
        return Err(Solution::zero(problem, Status::broken()));
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

/// Runs `iterate` on the reduced problem and its ε; `None` from it means that nothing usable was reached. `iterate` is run
/// once, or once for every working set where Φ is too large to be at hand as a whole.
pub(super) fn solve_reduced(
    problem: &Problem,
    mut iterate: impl FnMut(&Reduced, f64) -> Option<Solution>,
) -> Solution {
    if let Err(settled) = settle(problem) {
        return settled;
    }
    let dictionary = problem.dictionary;
    if dictionary.rows().saturating_mul(dictionary.cols()) <= WHOLE {
        return solve_whole(problem, &mut iterate);
    }
    grow(problem, |small| solve_whole(small, &mut iterate))
}

fn solve_whole(
    problem: &Problem,
    iterate: &mut impl FnMut(&Reduced, f64) -> Option<Solution>,
) -> Solution {
    let reduced = Reduced::new(problem);
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
