//! A solver that needs every column at hand, on a dictionary too large for that.
//!
//! In: a problem and a way to solve small ones. Out: the solution of the whole problem. Solve on a working set, price all
//! columns with its dual point, take in those whose bounds are broken, until none is.

use std::collections::BTreeSet;

use super::reduce::norm;
use super::{Problem, Solution, Status};
use crate::dictionary::{Dense, Dictionary, Strongest};

/// Columns of the first working set and most that a round adds, for each row.
const FIRST: usize = 4;
const MORE: usize = 2;
const ROUNDS: usize = 100;
/// Excess over |φ_jᵀλ| ≤ ‖φ_j‖ that a solver's own accuracy may leave.
const VIOLATION: f64 = 1e-8;
/// Correlation with a residual that no column explains.
const UNRELATED: f64 = 1e-7;

/// Solves `problem` by `solve` on growing sets of its columns.
pub(super) fn grow(problem: &Problem, mut solve: impl FnMut(&Problem) -> Solution) -> Solution {
    let dictionary = problem.dictionary;
    let rows = dictionary.rows();
    let first = dictionary.strongest(problem.target, FIRST * rows, 0.0);
    let mut columns: BTreeSet<usize> = numbers(&first).collect();
    let mut iterations = 0;
    for _ in 0..ROUNDS {
        let at_hand: Vec<usize> = columns.iter().copied().collect();
        let small = restrict(dictionary, &at_hand);
        let mut found = solve(&Problem {
            dictionary: &small,
            ..*problem
        });
        iterations += found.iterations;
        found.iterations = iterations;
        found
            .coefficients
            .iter_mut()
            .for_each(|(j, _)| *j = at_hand[*j]);
        let before = columns.len();
        if found.status != Status::Interrupted {
            columns.extend(numbers(&price(problem, &found)));
        }
        if columns.len() == before {
            return found;
        }
    }
    Solution::zero(problem, Status::broken())
}

/// Columns that would change the answer.
fn price(problem: &Problem, found: &Solution) -> Strongest {
    let most = MORE * problem.dictionary.rows();
    if !matches!(found.status, Status::Inconsistent { .. }) {
        return problem
            .dictionary
            .strongest(&found.dual, most, 1.0 + VIOLATION);
    }
    let mut left = problem.left(&found.coefficients);
    let length = norm(&left);
    left.iter_mut()
        .for_each(|x| *x /= length.max(f64::MIN_POSITIVE));
    problem.dictionary.strongest(&left, most, UNRELATED)
}

fn numbers(found: &Strongest) -> impl Iterator<Item = usize> {
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

#[cfg(test)]
mod tests {
    use sidc_progress::Unwatched;

    use super::*;
    use crate::planted::planted;
    use crate::{Clarabel, Solver};
    use sidc_random::Numbers;

    /// From 48 of 900 columns the set grows by those that break their bounds, and by no others.
    #[test]
    fn only_columns_that_break_their_bounds_join() {
        let (rows, cols) = (12, 900);
        let (dictionary, target) = planted(&mut Numbers(11), (rows, cols), &[10, 890], 0.0);
        let problem = Problem {
            dictionary: &dictionary,
            target: &target,
            tolerance: 0.0,
        };
        let mut sizes = Vec::new();
        let mut steps = 0;
        let found = grow(&problem, |small| {
            sizes.push(small.dictionary.cols());
            let found = Clarabel.solve(small, &mut Unwatched);
            steps += found.iterations;
            found
        });
        assert_eq!(found.status, Status::Solved);
        assert_eq!(found.iterations, steps);
        assert_eq!(sizes.first(), Some(&(FIRST * rows)));
        assert!(
            sizes.len() > 1 && sizes.is_sorted_by(|a, b| a < b),
            "{sizes:?}"
        );
        assert!(
            sizes.windows(2).all(|s| s[1] - s[0] <= MORE * rows),
            "{sizes:?}"
        );
        assert!(sizes.last().is_some_and(|n| 2 * n < cols), "{sizes:?}");
        let whole = Clarabel.solve(&problem, &mut Unwatched);
        for (j, a) in whole.coefficients.iter().filter(|(_, a)| a.abs() > 1e-6) {
            assert!((found.coefficient(*j) - a).abs() < 1e-6, "{j}");
        }
        assert!(dictionary.strongest(&found.dual, 1, 0.0).largest() <= 1.0 + 1e-7);
    }
}
