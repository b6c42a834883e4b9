//! Whether a problem without an answer is infeasible or was only solved inaccurately.

use crate::least_squares::minimum_norm_least_squares;
use crate::linalg::{nonzero, norm};
use crate::problem::{Problem, Solution, Status};
use crate::thresholds::CERTIFICATES;

/// The least-squares answer as [`Status::Inconsistent`] if no a reaches ε; otherwise what the solver found, which is at worst
/// inaccurate.
pub(super) fn diagnose(problem: &Problem, found: Solution) -> Solution {
    let fit = minimum_norm_least_squares(problem.dictionary, problem.target);
    let allowed = problem
        .tolerance
        .max(CERTIFICATES.consistent * norm(problem.target));
    if fit.residual <= allowed {
        let status = match found.status {
            Status::Inconsistent { residual } => Status::Inaccurate {
                gap: f64::INFINITY,
                residual: residual / nonzero(norm(problem.target)),
            },
            other => other,
        };
        return Solution { status, ..found };
    }
    Solution {
        coefficients: fit.coefficients,
        dual: vec![0.0; problem.target.len()],
        status: Status::Inconsistent {
            residual: fit.residual,
        },
        iterations: found.iterations,
    }
}
