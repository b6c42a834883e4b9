//! The default solver: the Lasso path on a growing working set, down to ε.
//!
//! In: any dictionary. Out: the end of the path, optimal over all columns; or the whole path. Few terms explain exact data,
//! so the path has few knots: tens of steps of O(M w) on w columns, and one pricing of all N columns a round. Columns are
//! taken in when λ breaks their bound; the path is then taken up where they first would have met it.

mod centre;
mod factor;
mod lasso;
mod path;
mod rounds;

pub use lasso::{Knot, lasso, lasso_path};

use super::frame::settle;
use super::least_squares::inconsistent;
use super::{Monitor, Problem, Solution, Solver, Status};
use path::Goal;
use rounds::Rounds;

/// Most entries of Φ that least squares looks at: a second's work.
const AFFORDABLE: usize = 1_000_000;

/// Homotopy on a working set. Where it gives up, which is where noise has to be fitted exactly, its answer is still optimal
/// for the residual it reached.
pub struct Homotopy;

impl Solver for Homotopy {
    fn name(&self) -> &'static str {
        "homotopy"
    }

    fn about(&self) -> &'static str {
        "Lasso path on a growing working set, for libraries of any size (default)"
    }

    fn solve(&self, problem: &Problem, monitor: Monitor) -> Solution {
        let size = match settle(problem) {
            Ok(size) => size,
            Err(settled) => return settled,
        };
        let target = unit(problem.target, size);
        let goal = Goal {
            tolerance: problem.tolerance / size,
            penalty: 0.0,
        };
        let Some(mut rounds) = Rounds::new(problem.dictionary, &target, goal) else {
            return Solution::zero(problem, Status::Inconsistent { residual: size });
        };
        let (place, status) = rounds.run(monitor);
        let solution = Solution {
            coefficients: rounds.raw(&place.coefficients, size),
            dual: rounds.centred(&place),
            status: match status {
                Status::Inconsistent { residual } => Status::Inconsistent {
                    residual: residual * size,
                },
                other => other,
            },
            iterations: rounds.steps(),
        };
        second_opinion(problem, solution)
    }
}

/// A path that ends short of ε on nearly dependent columns cannot tell a contradiction from rounding; least squares can,
/// where it is affordable.
fn second_opinion(problem: &Problem, solution: Solution) -> Solution {
    let (rows, cols) = (problem.dictionary.rows(), problem.dictionary.cols());
    let entries = rows.saturating_mul(cols);
    match solution.status {
        Status::Inaccurate { .. } | Status::Inconsistent { .. } if entries <= AFFORDABLE => {
            inconsistent(problem, solution)
        }
        _ => solution,
    }
}

/// y/‖y‖
fn unit(target: &[f64], size: f64) -> Vec<f64> {
    target.iter().map(|y| y / size).collect()
}
