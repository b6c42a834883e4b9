//! Basis pursuit by the Lasso path: the end of the path at ε.

use super::path_in_progress::start;
use super::side_by_side::side_by_side;
use crate::problem::{Problem, Solution};
use crate::solver::Solver;
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

    fn gives_up(&self) -> bool {
        true
    }

    fn solve_all(
        &self,
        problems: &[Problem],
        most_steps: usize,
        observer: &mut dyn Observer,
    ) -> Vec<Solution> {
        side_by_side(problems, most_steps, observer)
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

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use sidc_progress::{Activity, Stop, Unwatched};

    use super::*;
    use crate::dictionary::Dictionary;
    use crate::linalg::norm;
    use crate::planted::planted;
    use crate::problem::Status;
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
