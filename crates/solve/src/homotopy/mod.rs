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
use super::{Problem, Solution, Solver, Status};
use path::Goal;
use rounds::Rounds;
use sidc_progress::Observer;

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

    fn solve(&self, problem: &Problem, observer: &mut dyn Observer) -> Solution {
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
        let (place, status) = rounds.run(observer);
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

#[cfg(test)]
mod tests {
    use sidc_progress::{Activity, Stop, Unwatched};
    use std::ops::ControlFlow;

    use super::*;
    use crate::dictionary::Dictionary;
    use crate::planted::planted;
    use crate::reduce::norm;
    use sidc_random::Numbers;

    /// Interrupted after each step in turn: once an answer was optimal over all columns, later ones are, though the columns at hand
    /// are few.
    #[test]
    fn what_was_proved_is_not_lost_when_stopped() {
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
            let largest = dictionary.strongest(&found.dual, 1, 0.0).largest();
            held.push(largest <= 1.0 + 1e-9);
        }
        let first = held.iter().position(|h| *h);
        assert!(first.is_some_and(|k| 2 * k < held.len()), "{held:?}");
        assert!(held.iter().skip(first.unwrap_or(0)).all(|h| *h), "{held:?}");
    }

    /// Where a path for exact data ends λ lies on bounds of columns that it only passed; off them it proves that there is no other answer.
    #[test]
    fn dual_points_of_exact_data_leave_room_off_the_support() {
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
