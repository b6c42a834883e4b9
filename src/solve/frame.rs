//! What every solver does around its own iterations: reduce, settle the cases that need none, tell misfit from inaccuracy.
//!
//! In: a [`Problem`] and the iterations on its reduced form. Out: a [`Solution`] with an honest status.

use super::least_squares::inconsistent;
use super::reduce::{Reduced, norm};
use super::working_set::grow;
use super::{Problem, Solution, Status};

/// Most entries of Φ that are put side by side, 40 MB; beyond, a working set grows.
const WHOLE: usize = 5_000_000;

/// Runs `iterate` on the reduced problem and its ε; `None` from it means that nothing usable was reached. `iterate` is run
/// once, or once for every working set where Φ is too large to be at hand as a whole.
pub(super) fn solve_reduced(
    problem: &Problem,
    mut iterate: impl FnMut(&Reduced, f64) -> Option<Solution>,
) -> Solution {
    let size = norm(problem.target);
    let entries = problem
        .dictionary
        .rows()
        .saturating_mul(problem.dictionary.cols());
    if entries <= WHOLE || !size.is_finite() || size <= problem.tolerance {
        return solve_whole(problem, &mut iterate);
    }
    grow(problem, |small| solve_whole(small, &mut iterate))
}

fn solve_whole(
    problem: &Problem,
    iterate: &mut impl FnMut(&Reduced, f64) -> Option<Solution>,
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
