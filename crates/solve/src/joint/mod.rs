//! Several problems whose coefficients are tied by linear rows, solved as one conic problem.
//!
//! In: blocks (one [`Problem`] each) and rows over their coefficients. Out: coefficients, dual point and multipliers, or that the
//! rows contradict each other or the data. Columns are priced, never all handed to the conic solver. It sees no names.

mod certificate;
mod eliminate;
mod fit;
mod least_distance;
mod programme;
mod rows;

use self::programme::{End, Goal, Programme};
use sidc_progress::{Observer, SolverProgress};

use super::Problem;
use super::reduce::{nonzero, norm};

pub use certificate::{JointProof, certify_joint};
pub use fit::{Fit, FitBlock, fit};
pub use rows::conflict;

/// How the left side of a row stands to its right side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    Equal,
    AtMost,
    /// Strictly less: solved as [`Sense::AtMost`], told apart only where rows contradict each other.
    Below,
}

/// `Σ weight · a_{block, column}  SENSE  right`, coefficients in the units of the raw columns.
#[derive(Clone, Debug)]
pub struct Row {
    /// (block, column, weight); a place stands at most once.
    pub entries: Vec<(usize, usize, f64)>,
    pub sense: Sense,
    pub right: f64,
}

/// `min Σ_e ‖D_e a_e‖₁/‖y_e‖ s.t. ‖Φ_e a_e − y_e‖₂ ≤ ε_e` and the rows.
pub struct Joint<'a> {
    pub blocks: Vec<Problem<'a>>,
    pub rows: Vec<Row>,
}

/// What the conic solver found; [`certify_joint`] says what it is worth.
#[derive(Clone, Debug)]
pub struct JointSolution {
    /// For each block the coefficients that are not zero, by rising column, in the units of the raw columns.
    pub coefficients: Vec<Vec<(usize, f64)>>,
    /// λ_e of each block, length M_e.
    pub duals: Vec<Vec<f64>>,
    /// ν of each row; at most zero for inequalities.
    pub multipliers: Vec<f64>,
    pub outcome: Outcome,
    pub iterations: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The conic solver met its own test, and no column of the dictionaries was left to add.
    Solved,
    /// It stopped short of that.
    Inaccurate,
    /// Rows and data admit no coefficients.
    Infeasible,
    Interrupted,
}

/// Rounds of adding columns.
const ROUNDS: usize = 40;
/// Columns added to a block in one round.
const ADDED: usize = 100;
/// Up to so many columns, all of a block take part from the start.
const SMALL: usize = 200;
/// Most columns of a block that take part.
const MOST: usize = 1500;
/// A column whose price exceeds 1 by this belongs into the working set.
const PRICED: f64 = 1e-7;
/// In the search for the nearest fit any correlation above this may shorten the residual.
const CORRELATED: f64 = 1e-6;
/// Residual beyond ε, relative to ‖y‖, that the conic solver leaves where there need be none.
const REACHED: f64 = 1e-7;

/// Solves by column generation (Bertsimas & Tsitsiklis, section 6.1): a conic programme on a working set, then every column of the
/// dictionaries is priced with its dual point. `start` proposes columns of each block.
pub fn solve_joint(
    joint: &Joint,
    start: &[Vec<usize>],
    observer: &mut dyn Observer,
) -> JointSolution {
    let mut sets = working_sets(joint, start);
    let mut iterations = 0;
    for round in 1..=ROUNDS {
        let programme = Programme::new(joint, &sets);
        let end = programme.run(Goal::Sparse);
        iterations += end.iterations;
        let grown = if end.infeasible {
            let near = programme.run(Goal::Nearest);
            iterations += near.iterations;
            let grown = grow(joint, &mut sets, &near, CORRELATED);
            if grown != Priced::Added {
                let feasible = near.excess.iter().all(|e| *e <= REACHED);
                let outcome = match feasible || !near.solved || grown == Priced::Left {
                    true => Outcome::Inaccurate,
                    false => Outcome::Infeasible,
                };
                return end.solution(outcome, iterations);
            }
            grown
        } else {
            grow(joint, &mut sets, &end, 1.0 + PRICED)
        };
        let progress = SolverProgress {
            round,
            iteration: iterations,
            ..SolverProgress::default()
        };
        if progress.tell(observer).is_break() {
            return end.solution(Outcome::Interrupted, iterations);
        }
        if grown != Priced::Added {
            let outcome = match end.solved && grown == Priced::None {
                true => Outcome::Solved,
                false => Outcome::Inaccurate,
            };
            return end.solution(outcome, iterations);
        }
    }
    let end = Programme::new(joint, &sets).run(Goal::Sparse);
    end.solution(Outcome::Inaccurate, iterations + end.iterations)
}

/// The smallest residuals that the rows allow, ‖Φ_e a_e − y_e‖/‖y_e‖ of each block, counted from ε_e: a block that reaches its ε
/// has that. Where blocks compete, their relative residuals are summed.
pub fn nearest(joint: &Joint, start: &[Vec<usize>]) -> Vec<f64> {
    let mut sets = working_sets(joint, start);
    let mut excess = Vec::new();
    for _ in 0..ROUNDS {
        let end = Programme::new(joint, &sets).run(Goal::Nearest);
        excess.clone_from(&end.excess);
        let reached = end.solved && excess.iter().all(|e| *e <= REACHED);
        if reached || grow(joint, &mut sets, &end, CORRELATED) != Priced::Added {
            break;
        }
    }
    let blocks = joint.blocks.iter().zip(excess);
    blocks
        .map(|(b, e)| b.tolerance / nonzero(norm(b.target)) + if e <= REACHED { 0.0 } else { e })
        .collect()
}

/// The proposed columns, all those that rows name, and the strongest for the target; small blocks whole. Rising.
fn working_sets(joint: &Joint, start: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let blocks = joint.blocks.iter().enumerate();
    blocks
        .map(|(e, problem)| {
            let n = problem.dictionary.cols();
            let mut set = named(joint, e);
            set.extend(start.get(e).into_iter().flatten().filter(|j| **j < n));
            if n <= SMALL {
                let norms = problem.dictionary.norms();
                set.extend((0..n).filter(|j| norms[*j] > 0.0));
            } else {
                let strongest = problem.dictionary.strongest(problem.target, ADDED, 0.0);
                set.extend(strongest.columns.iter().map(|(j, _)| *j));
            }
            set.sort_unstable();
            set.dedup();
            set
        })
        .collect()
}

/// Columns of a block that rows name.
fn named(joint: &Joint, block: usize) -> Vec<usize> {
    let entries = joint.rows.iter().flat_map(|r| &r.entries);
    entries
        .filter(|(b, _, _)| *b == block)
        .map(|(_, j, _)| *j)
        .collect()
}

/// What became of the columns that a dual point prices too high.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Priced {
    /// There are none.
    None,
    Added,
    /// There are some, and no room for them.
    Left,
}

/// Adds the columns that the dual point prices above `bound`. Named columns are all there already.
fn grow(joint: &Joint, sets: &mut [Vec<usize>], end: &End, bound: f64) -> Priced {
    let mut priced = Priced::None;
    for ((problem, set), lambda) in joint.blocks.iter().zip(sets).zip(&end.duals) {
        let size = norm(problem.target);
        let scaled: Vec<f64> = lambda.iter().map(|l| l * size).collect();
        let wanted = ADDED + set.len();
        let strongest = problem.dictionary.strongest(&scaled, wanted, bound);
        let fresh = strongest.columns.iter().map(|(j, _)| *j);
        let fresh: Vec<usize> = fresh
            .filter(|j| set.binary_search(j).is_err())
            .take(ADDED)
            .collect();
        if fresh.is_empty() {
            continue;
        }
        if set.len() < MOST {
            set.extend(fresh);
            set.sort_unstable();
            priced = Priced::Added;
        } else if priced == Priced::None {
            priced = Priced::Left;
        }
    }
    priced
}
