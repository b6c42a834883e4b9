//! Basis pursuit under linear constraints by column generation (Bertsimas & Tsitsiklis, section 6.1).
//!
//! In: a constrained problem, and columns to start from. Out: coefficients, dual point and multipliers, or that the constraints
//! contradict each other or the data. A conic program is solved on working sets; all other columns are only priced.

use sidc_progress::{Observer, SolverProgress};

use super::conic_program::{ConicProgram, ConicSolution, Objective};
use super::problem::{ConstrainedProblem, ConstrainedSolution, Outcome};
use crate::linalg::{nonzero, norm};
use crate::thresholds::CONSTRAINED;

/// Solves the problem. `start` proposes columns of each block.
pub fn solve_constrained(
    problem: &ConstrainedProblem,
    start: &[Vec<usize>],
    observer: &mut dyn Observer,
) -> ConstrainedSolution {
    let mut sets = working_sets(problem, start);
    let mut iterations = 0;
    for round in 1..=CONSTRAINED.max_rounds {
        let program = ConicProgram::new(problem, &sets);
        let found = program.run(Objective::OneNorm);
        iterations += found.iterations;
        let pricing = if found.infeasible {
            let least = program.run(Objective::Residuals);
            iterations += least.iterations;
            let pricing = add_columns(problem, &mut sets, &least, CONSTRAINED.correlated);
            if pricing != Pricing::Added {
                let feasible = least.excess.iter().all(|e| *e <= CONSTRAINED.reached);
                let outcome = match feasible || !least.solved || pricing == Pricing::NoRoom {
                    true => Outcome::Inaccurate,
                    false => Outcome::Infeasible,
                };
                return found.solution(outcome, iterations);
            }
            pricing
        } else {
            add_columns(problem, &mut sets, &found, 1.0 + CONSTRAINED.violation)
        };
        let progress = SolverProgress {
            round,
            iteration: iterations,
            ..SolverProgress::default()
        };
        if progress.tell(observer).is_break() {
            return found.solution(Outcome::Interrupted, iterations);
        }
        if pricing != Pricing::Added {
            let outcome = match found.solved && pricing == Pricing::Feasible {
                true => Outcome::Solved,
                false => Outcome::Inaccurate,
            };
            return found.solution(outcome, iterations);
        }
    }
    let found = ConicProgram::new(problem, &sets).run(Objective::OneNorm);
    found.solution(Outcome::Inaccurate, iterations + found.iterations)
}

/// The least residuals ‖Φ_e a_e − y_e‖/‖y_e‖ that the constraints allow, or ε_e/‖y_e‖ for a block that can reach its ε. Where
/// blocks compete, the sum of their excesses over ε_e/‖y_e‖ is minimised.
pub fn least_residuals(problem: &ConstrainedProblem, start: &[Vec<usize>]) -> Vec<f64> {
    let mut sets = working_sets(problem, start);
    let mut excess = Vec::new();
    for _ in 0..CONSTRAINED.max_rounds {
        let found = ConicProgram::new(problem, &sets).run(Objective::Residuals);
        excess.clone_from(&found.excess);
        let reached = found.solved && excess.iter().all(|e| *e <= CONSTRAINED.reached);
        if reached
            || add_columns(problem, &mut sets, &found, CONSTRAINED.correlated) != Pricing::Added
        {
            break;
        }
    }
    let blocks = problem.blocks.iter().zip(excess);
    blocks
        .map(|(b, e)| {
            b.tolerance / nonzero(norm(b.target)) + if e <= CONSTRAINED.reached { 0.0 } else { e }
        })
        .collect()
}

/// The proposed columns, those that constraints name, and those of largest correlation with the target; small blocks whole. Rising.
fn working_sets(constrained: &ConstrainedProblem, start: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let blocks = constrained.blocks.iter().enumerate();
    blocks
        .map(|(e, problem)| {
            let n = problem.dictionary.cols();
            let mut set = constrained.named_columns(e);
            set.extend(start.get(e).into_iter().flatten().filter(|j| **j < n));
            if n <= CONSTRAINED.whole_block {
                set.extend((0..n).filter(|j| problem.dictionary.norm(*j) > 0.0));
            } else {
                let priced =
                    problem
                        .dictionary
                        .price(problem.target, CONSTRAINED.added_columns, 0.0);
                set.extend(priced.columns.iter().map(|(j, _)| *j));
            }
            set.sort_unstable();
            set.dedup();
            set
        })
        .collect()
}

/// What pricing with a dual point showed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Pricing {
    /// No column violates its bound.
    Feasible,
    Added,
    /// Some do, and the working set is full.
    NoRoom,
}

/// Adds the columns whose reduced cost exceeds `bound`. Columns that constraints name are members already.
fn add_columns(
    constrained: &ConstrainedProblem,
    sets: &mut [Vec<usize>],
    solution: &ConicSolution,
    bound: f64,
) -> Pricing {
    let mut pricing = Pricing::Feasible;
    for ((problem, set), lambda) in constrained.blocks.iter().zip(sets).zip(&solution.duals) {
        let target_norm = norm(problem.target);
        let scaled: Vec<f64> = lambda.iter().map(|l| l * target_norm).collect();
        let wanted = CONSTRAINED.added_columns + set.len();
        let priced = problem.dictionary.price(&scaled, wanted, bound);
        let entering = priced.columns.iter().map(|(j, _)| *j);
        let entering: Vec<usize> = entering
            .filter(|j| set.binary_search(j).is_err())
            .take(CONSTRAINED.added_columns)
            .collect();
        if entering.is_empty() {
            continue;
        }
        if set.len() < CONSTRAINED.max_columns {
            set.extend(entering);
            set.sort_unstable();
            pricing = Pricing::Added;
        } else if pricing == Pricing::Feasible {
            pricing = Pricing::NoRoom;
        }
    }
    pricing
}
