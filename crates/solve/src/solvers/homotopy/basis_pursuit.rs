//! Basis pursuit by the Lasso path: the end of the path at ε.

use super::column_generation::ColumnGeneration;
use super::path::{Goal, PathPoint};
use super::side_by_side::side_by_side;
use crate::linalg::quotient;
use crate::problem::{Problem, Solution, Status};
use crate::solver::Solver;
use crate::solvers::infeasibility::diagnose;
use crate::solvers::presolve::presolve;
use crate::thresholds::HOMOTOPY;
use sidc_progress::Observer;

/// Homotopy on a working set. Where it gives up, which is where noise would have to be fitted exactly, its answer is still optimal
/// for the residual it has.
pub struct Homotopy;

impl Solver for Homotopy {
    fn name(&self) -> &'static str {
        "homotopy"
    }

    fn about(&self) -> &'static str {
        "Lasso path on a growing working set, for libraries of any size (default)"
    }

    fn solve_all(&self, problems: &[Problem], observer: &mut dyn Observer) -> Vec<Solution> {
        side_by_side(problems, observer)
    }

    fn solve(&self, problem: &Problem, observer: &mut dyn Observer) -> Solution {
        let started = start(problem);
        let mut running = match started.run(problem) {
            Ok(running) => running,
            Err(solved) => return solved,
        };
        loop {
            if let Some(solution) = running.round(observer) {
                return solution;
            }
        }
    }
}

/// A problem brought to a target of length one.
pub(super) struct Started {
    target: Vec<f64>,
    /// ‖y‖, or the answer that needs no path.
    target_norm: Result<f64, Solution>,
}

/// Presolve.
pub(super) fn start(problem: &Problem) -> Started {
    let target_norm = presolve(problem);
    let target = target_norm.as_ref().map(|n| quotient(problem.target, *n));
    Started {
        target: target.unwrap_or_default(),
        target_norm,
    }
}

impl Started {
    /// The path at its start, or the answer that needs none.
    pub fn run<'a>(&'a self, problem: &'a Problem<'a>) -> Result<Running<'a>, Solution> {
        let target_norm = self.target_norm.clone()?;
        let goal = Goal {
            tolerance: problem.tolerance / target_norm,
            penalty: 0.0,
        };
        let path = ColumnGeneration::new(problem.dictionary, &self.target, goal);
        let residual = target_norm;
        let none = || Solution::zero(problem, Status::Inconsistent { residual });
        Ok(Running {
            problem,
            target_norm,
            path: path.ok_or_else(none)?,
        })
    }
}

/// A path on its way to ε.
pub(super) struct Running<'a> {
    problem: &'a Problem<'a>,
    target_norm: f64,
    path: ColumnGeneration<'a>,
}

impl Running<'_> {
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

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use sidc_progress::{Activity, Stop, Unwatched};

    use super::*;
    use crate::dictionary::Dictionary;
    use crate::linalg::norm;
    use crate::planted::planted;
    use sidc_random::Numbers;

    /// Interrupted after each step in turn: once an answer was optimal over all columns, later ones are too.
    #[test]
    fn an_optimal_answer_is_not_lost_when_stopped() {
        let mut numbers = Numbers(3);
        let (dictionary, mut target) =
            planted(&mut numbers, (40, 2000), &[5, 700, 1234, 1999], 0.0);
        target.iter_mut().for_each(|y| *y += 0.3 * numbers.next());
        let problem = Problem {
            dictionary: &dictionary,
            target: &target,
            tolerance: 0.05 * norm(&target),
        };
        let whole = Homotopy.solve(&problem, &mut Unwatched);
        assert_eq!(whole.status, Status::Solved);
        let mut held = Vec::new();
        for stop in 1..whole.iterations {
            let mut calls = 0;
            let found = Homotopy.solve(&problem, &mut |_: Activity| {
                calls += 1;
                match calls < stop {
                    true => ControlFlow::Continue(()),
                    false => ControlFlow::Break(Stop::Interrupted),
                }
            });
            assert_eq!(found.status, Status::Interrupted);
            let largest = dictionary.price(&found.dual, 1, 0.0).largest();
            held.push(largest <= 1.0 + 1e-9);
        }
        let first = held.iter().position(|h| *h);
        assert!(first.is_some_and(|k| 2 * k < held.len()), "{held:?}");
        assert!(held.iter().skip(first.unwrap_or(0)).all(|h| *h), "{held:?}");
    }

    /// At the end of a path for exact data λ lies on bounds of columns off the support; moved off them it proves uniqueness.
    #[test]
    fn dual_points_of_exact_data_have_a_margin_off_the_support() {
        let mut numbers = Numbers(17);
        for _ in 0..20 {
            let (dictionary, target) = planted(&mut numbers, (20, 60), &[7, 30, 59], 1.5);
            let problem = Problem {
                dictionary: &dictionary,
                target: &target,
                tolerance: 0.0,
            };
            let found = Homotopy.solve(&problem, &mut Unwatched);
            let proof = crate::certify(&problem, &found.coefficients, &found.dual);
            assert!(proof.proves_unique && proof.margin > 0.02, "{proof:?}");
        }
    }
}
