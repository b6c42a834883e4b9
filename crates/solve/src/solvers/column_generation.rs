//! Column generation (Bertsimas & Tsitsiklis, section 6.1): for solvers that store Φ, on dictionaries too large for that.
//!
//! In: a problem and a way to solve stored ones. Out: the solution of the whole problem. A working set of columns is solved, all
//! columns are priced with its dual point, and those that violate their bounds enter, until none does.

use std::collections::BTreeSet;

use super::infeasibility::diagnose;
use super::presolve::presolve;
use super::range_reduction::ReducedProblem;
use crate::dictionary::{Dense, Dictionary, Graded, Grades, Priced};
use crate::linalg::{nonzero, norm};
use crate::problem::{Problem, Solution, Status};
use crate::thresholds::COLUMN_GENERATION;

/// Solves `problem` by `solve` on growing working sets.
pub(super) fn generate_columns(
    problem: &Problem,
    mut solve: impl FnMut(&Problem) -> Solution,
) -> Solution {
    let dictionary = problem.dictionary;
    let rows = dictionary.rows();
    let first = dictionary.price(
        problem.target,
        COLUMN_GENERATION.initial_columns * rows,
        0.0,
    );
    let mut columns: BTreeSet<usize> = indices(&first).collect();
    let mut iterations = 0;
    for _ in 0..COLUMN_GENERATION.max_rounds {
        let working_set: Vec<usize> = columns.iter().copied().collect();
        let restricted = restrict(dictionary, &working_set);
        let grade = |j: &usize| dictionary.weight(*j) / nonzero(dictionary.norm(*j));
        let grades = Grades::of_columns(working_set.iter().map(grade).collect());
        let mut found = solve(&Problem {
            dictionary: &Graded {
                columns: &restricted,
                grades: &grades,
            },
            ..*problem
        });
        iterations += found.iterations;
        found.iterations = iterations;
        found
            .coefficients
            .iter_mut()
            .for_each(|(j, _)| *j = working_set[*j]);
        let before = columns.len();
        if found.status != Status::Interrupted {
            columns.extend(indices(&violating(problem, &found)));
        }
        if columns.len() == before {
            return found;
        }
    }
    Solution::zero(problem, Status::broken_down())
}

/// Columns that would change the answer: those whose bounds are violated or, where ε is not reached, that correlate with the residual.
fn violating(problem: &Problem, found: &Solution) -> Priced {
    let most = COLUMN_GENERATION.added_columns * problem.dictionary.rows();
    if !matches!(found.status, Status::Inconsistent { .. }) {
        return problem
            .dictionary
            .price(&found.dual, most, 1.0 + COLUMN_GENERATION.violation);
    }
    let mut residual = problem.residual(&found.coefficients);
    let length = norm(&residual);
    residual
        .iter_mut()
        .for_each(|x| *x /= length.max(f64::MIN_POSITIVE));
    problem
        .dictionary
        .price(&residual, most, COLUMN_GENERATION.unrelated)
}

fn indices(found: &Priced) -> impl Iterator<Item = usize> {
    found.columns.iter().map(|(j, _)| *j)
}

/// The chosen columns, stored.
fn restrict(dictionary: &dyn Dictionary, columns: &[usize]) -> Dense {
    let rows = dictionary.rows();
    let mut values = vec![0.0; rows * columns.len()];
    for (out, j) in values.chunks_exact_mut(rows.max(1)).zip(columns) {
        dictionary.column(*j, out);
    }
    Dense::new(rows, values)
}

/// Runs `iterate` on the reduced problem and its ε; it returns `None` if it found nothing usable. It is run once, or once for every
/// working set where Φ is too large to be stored.
pub(super) fn solve_reduced(
    problem: &Problem,
    mut iterate: impl FnMut(&ReducedProblem, f64) -> Option<Solution>,
) -> Solution {
    if let Err(solved) = presolve(problem) {
        return solved;
    }
    let dictionary = problem.dictionary;
    if dictionary.rows().saturating_mul(dictionary.cols()) <= COLUMN_GENERATION.stored_entries {
        return solve_stored(problem, &mut iterate);
    }
    generate_columns(problem, |restricted| solve_stored(restricted, &mut iterate))
}

fn solve_stored(
    problem: &Problem,
    iterate: &mut impl FnMut(&ReducedProblem, f64) -> Option<Solution>,
) -> Solution {
    let reduced = ReducedProblem::new(problem);
    let Some(tolerance) = reduced
        .reduced_tolerance()
        .filter(|_| !reduced.singular_values.is_empty())
    else {
        let residual = f64::INFINITY;
        return diagnose(
            problem,
            Solution::zero(problem, Status::Inconsistent { residual }),
        );
    };
    let Some(solution) = iterate(&reduced, tolerance) else {
        return Solution::zero(problem, Status::broken_down());
    };
    match solution.status {
        Status::Inaccurate { .. } => diagnose(problem, solution),
        _ => solution,
    }
}
