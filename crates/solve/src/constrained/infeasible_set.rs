//! Constraints that contradict each other, whatever the data.
//!
//! In: constraints. Out: an irreducible infeasible set of them, or that all can be satisfied.

use std::collections::BTreeMap;

use super::elimination::{Hyperplane, eliminate};
use super::least_distance::{HalfSpace, least_distance};
use super::problem::{LinearConstraint, Sense};
use crate::thresholds::LINEAR_CONSTRAINTS;

/// Constraints that no coefficients satisfy together, though some satisfy them without any one. `None` if all can be satisfied.
pub fn irreducible_infeasible_set(rows: &[LinearConstraint]) -> Option<Vec<usize>> {
    let mut kept: Vec<usize> = Vec::new();
    let mut from = 0;
    let feasible = |kept: &[usize], from: usize| {
        let chosen: Vec<usize> = kept.iter().copied().chain(from..rows.len()).collect();
        is_feasible(rows, &chosen)
    };
    if feasible(&kept, from) {
        return None;
    }
    // The last row such that it and those after it, with those kept, are infeasible belongs to the set. It is found by bisection (the
    // deletion filter of Chinneck & Dravnieks 1991).
    while from < rows.len() && (kept.is_empty() || feasible(&kept, rows.len())) {
        let mut beyond = rows.len();
        while beyond - from > 1 {
            let middle = from.midpoint(beyond);
            match feasible(&kept, middle) {
                true => beyond = middle,
                false => from = middle,
            }
        }
        kept.push(from);
        from += 1;
    }
    Some(kept)
}

fn is_feasible(rows: &[LinearConstraint], chosen: &[usize]) -> bool {
    let rows: Vec<&LinearConstraint> = chosen.iter().filter_map(|k| rows.get(*k)).collect();
    let mut places = BTreeMap::new();
    for (block, column, _) in rows.iter().flat_map(|r| &r.entries) {
        let next = places.len();
        places.entry((*block, *column)).or_insert(next);
    }
    let n = places.len();
    let scale = rows.iter().map(|r| scaled_right(r)).fold(0.0, f64::max);
    let scale = if scale > 0.0 { scale } else { 1.0 };
    let plane = |row: &LinearConstraint| {
        let mut weights = vec![0.0; n];
        let largest = largest_weight(row);
        for (block, column, w) in &row.entries {
            if let Some(k) = places.get(&(*block, *column)) {
                weights[*k] += w / largest;
            }
        }
        let strict = if row.sense == Sense::Below {
            LINEAR_CONSTRAINTS.strict
        } else {
            0.0
        };
        Hyperplane {
            weights,
            right: row.right / largest / scale - strict,
        }
    };
    let of = |equal: bool| -> Vec<Hyperplane> {
        let rows = rows.iter().filter(|r| (r.sense == Sense::Equal) == equal);
        rows.map(|r| plane(r)).collect()
    };
    let (equal, below) = (of(true), of(false));
    let Some(solutions) = eliminate(n, &equal.iter().collect::<Vec<_>>()) else {
        return false;
    };
    // w·(constant + T u) ≤ d is −wᵀT u ≥ w·constant − d.
    let spaces: Vec<HalfSpace> = below
        .iter()
        .map(|p| HalfSpace {
            normal: solutions
                .matrix
                .column_iter()
                .map(|t| -t.iter().zip(&p.weights).map(|(t, w)| t * w).sum::<f64>())
                .map(|g| {
                    if g.abs() < LINEAR_CONSTRAINTS.rounding {
                        0.0
                    } else {
                        g
                    }
                })
                .collect(),
            height: p.value(&solutions.constant) - p.right,
        })
        .collect();
    least_distance(&spaces).is_some()
}

fn largest_weight(row: &LinearConstraint) -> f64 {
    let largest = row.entries.iter().fold(0.0_f64, |m, e| m.max(e.2.abs()));
    if largest > 0.0 { largest } else { 1.0 }
}

fn scaled_right(row: &LinearConstraint) -> f64 {
    row.right.abs() / largest_weight(row)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Sense::{AtMost, Below, Equal};

    fn row(entries: &[(usize, f64)], sense: Sense, right: f64) -> LinearConstraint {
        LinearConstraint {
            entries: entries.iter().map(|(j, w)| (0, *j, *w)).collect(),
            sense,
            right,
        }
    }

    #[test]
    fn the_rows_in_conflict_are_named_and_no_others() {
        let rows = [
            row(&[(0, 1.0)], AtMost, 5.0),
            row(&[(1, 1.0), (2, 1.0)], Equal, 0.0),
            row(&[(1, -1.0)], AtMost, -1.0),
            row(&[(3, 1.0)], Below, 0.0),
            row(&[(2, -1.0)], Below, 0.0),
        ];
        // a1 + a2 = 0, a1 ≥ 1, a2 > 0
        assert_eq!(irreducible_infeasible_set(&rows), Some(vec![1, 2, 4]));
        assert_eq!(irreducible_infeasible_set(&rows[..4]), None);
    }

    #[test]
    fn strict_rows_exclude_their_bounds() {
        let twice = |sense| {
            [
                row(&[(0, 1.0)], sense, 2.0),
                row(&[(0, -1.0)], AtMost, -2.0),
            ]
        };
        assert_eq!(irreducible_infeasible_set(&twice(AtMost)), None);
        assert_eq!(irreducible_infeasible_set(&twice(Below)), Some(vec![0, 1]));
        let signs = [row(&[(0, 1.0)], Below, 0.0), row(&[(0, -1.0)], Below, 0.0)];
        assert_eq!(irreducible_infeasible_set(&signs), Some(vec![0, 1]));
    }

    #[test]
    fn values_given_twice_agree_or_not() {
        let given = |a, b| [row(&[(0, 1.0)], Equal, a), row(&[(0, 2.0)], Equal, b)];
        assert_eq!(
            irreducible_infeasible_set(&given(0.3, 2.0 * (0.1 + 0.2))),
            None
        );
        assert_eq!(
            irreducible_infeasible_set(&given(0.3, 0.7)),
            Some(vec![0, 1])
        );
        // Nothing is left to choose: 0 = 1.
        assert_eq!(
            irreducible_infeasible_set(&[row(&[], Equal, 1.0)]),
            Some(vec![0])
        );
        assert_eq!(irreducible_infeasible_set(&[row(&[], AtMost, 1.0)]), None);
        assert_eq!(
            irreducible_infeasible_set(&[row(&[], AtMost, -1.0)]),
            Some(vec![0])
        );
        assert_eq!(
            irreducible_infeasible_set(&[row(&[], Below, 0.0)]),
            Some(vec![0])
        );
    }

    /// What is large and small is relative to the rows themselves, both their weights and their right sides.
    #[test]
    fn the_size_of_numbers_does_not_matter() {
        for size in [1e-9, 1.0, 1e12] {
            for weight in [1e-8, 1.0, 1e9] {
                let between = |low: f64, high: f64| {
                    [
                        row(&[(0, weight)], AtMost, weight * high * size),
                        row(&[(0, -weight)], AtMost, -weight * low * size),
                    ]
                };
                assert_eq!(
                    irreducible_infeasible_set(&between(1.0, 2.0)),
                    None,
                    "{size} {weight}"
                );
                assert_eq!(
                    irreducible_infeasible_set(&between(2.0, 1.0)),
                    Some(vec![0, 1]),
                    "{size} {weight}"
                );
                let signs = [
                    row(&[(0, weight)], Below, 0.0),
                    row(&[(0, -weight)], Below, 0.0),
                ];
                assert_eq!(irreducible_infeasible_set(&signs), Some(vec![0, 1]));
            }
        }
        // A place may be named twice: 2 a ≤ 2 and a ≥ 2.
        let twice = [
            row(&[(0, 1.0), (0, 1.0)], AtMost, 2.0),
            row(&[(0, -1.0)], AtMost, -2.0),
        ];
        assert_eq!(irreducible_infeasible_set(&twice), Some(vec![0, 1]));
    }
}
