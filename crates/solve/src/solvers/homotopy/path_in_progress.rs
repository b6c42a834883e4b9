//! A path on its way from a = 0 to ε, round by round.
//!
//! In: a problem. Out: its answer once the path has ended. Does not decide which of several paths goes on next.

use super::column_generation::ColumnGeneration;
use super::path::{Goal, PathPoint};
use crate::linalg::quotient;
use crate::problem::{Problem, Solution, Status};
use crate::solvers::infeasibility::diagnose;
use crate::solvers::presolve::presolve;
use crate::thresholds::HOMOTOPY;
use sidc_progress::Observer;

/// A problem brought to a target of length one.
pub(super) struct PreparedPath {
    target: Vec<f64>,
    /// ‖y‖, or the answer that needs no path.
    target_norm: Result<f64, Solution>,
}

/// Presolve.
pub(super) fn start(problem: &Problem) -> PreparedPath {
    let target_norm = presolve(problem);
    let target = target_norm.as_ref().map(|n| quotient(problem.target, *n));
    PreparedPath {
        target: target.unwrap_or_default(),
        target_norm,
    }
}

impl PreparedPath {
    /// The path at its start, or the answer that needs none.
    pub fn run<'a>(&'a self, problem: &'a Problem<'a>) -> Result<PathInProgress<'a>, Solution> {
        let target_norm = self.target_norm.clone()?;
        let goal = Goal {
            tolerance: problem.tolerance / target_norm,
            penalty: 0.0,
        };
        let path = ColumnGeneration::new(problem.dictionary, &self.target, goal);
        let residual = target_norm;
        let none = || Solution::zero(problem, Status::Inconsistent { residual });
        Ok(PathInProgress {
            problem,
            target_norm,
            path: path.ok_or_else(none)?,
        })
    }
}

/// A path on its way to ε.
pub(super) struct PathInProgress<'a> {
    problem: &'a Problem<'a>,
    target_norm: f64,
    path: ColumnGeneration<'a>,
}

impl PathInProgress<'_> {
    pub fn steps(&self) -> usize {
        self.path.steps()
    }

    /// One round; the answer if it was the last.
    pub fn round(&mut self, observer: &mut dyn Observer) -> Option<Solution> {
        let (point, status) = self.path.round(observer);
        let solution = self.solution(&point, status?);
        Some(check_infeasibility(self.problem, solution))
    }

    /// What there is so far: nothing that fits.
    pub fn given_up(&self) -> Solution {
        Solution {
            iterations: self.steps(),
            ..Solution::zero(self.problem, Status::Interrupted)
        }
    }

    fn solution(&self, point: &PathPoint, status: Status) -> Solution {
        Solution {
            coefficients: self.path.raw(&point.coefficients, self.target_norm),
            dual: self.path.interior_dual(point),
            status: match status {
                Status::Inconsistent { residual } => Status::Inconsistent {
                    residual: residual * self.target_norm,
                },
                other => other,
            },
            iterations: self.steps(),
        }
    }
}

/// A path that ends short of ε on nearly dependent columns cannot tell infeasibility from rounding. Least squares can, where Φ is
/// not too large.
fn check_infeasibility(problem: &Problem, solution: Solution) -> Solution {
    let (rows, cols) = (problem.dictionary.rows(), problem.dictionary.cols());
    let entries = rows.saturating_mul(cols);
    match solution.status {
        Status::Inaccurate { .. } | Status::Inconsistent { .. }
            if entries <= HOMOTOPY.least_squares_entries =>
        {
            diagnose(problem, solution)
        }
        _ => solution,
    }
}
