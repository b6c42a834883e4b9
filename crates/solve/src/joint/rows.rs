//! Rows alone, without data: can any coefficients obey them, and if not, which of them contradict each other?

use std::collections::BTreeMap;

use super::eliminate::{Plane, eliminate};
use super::least_distance::{HalfSpace, least_distance};
use super::{Row, Sense};

/// By how much strict rows are tightened, relative to the largest right side.
const STRICT: f64 = 1e-5;

/// A smallest set of rows that no coefficients obey together: without any one of them there are some. `None` if all can be obeyed.
pub fn conflict(rows: &[Row]) -> Option<Vec<usize>> {
    let mut kept: Vec<usize> = Vec::new();
    let mut from = 0;
    let obeyed = |kept: &[usize], from: usize| {
        let chosen: Vec<usize> = kept.iter().copied().chain(from..rows.len()).collect();
        obeyable(rows, &chosen)
    };
    if obeyed(&kept, from) {
        return None;
    }
    // The last row from which on the others contradict is one of them (the deletion filter of Chinneck & Dravnieks 1991, halving).
    while from < rows.len() && (kept.is_empty() || obeyed(&kept, rows.len())) {
        let mut beyond = rows.len();
        while beyond - from > 1 {
            let middle = from.midpoint(beyond);
            match obeyed(&kept, middle) {
                true => beyond = middle,
                false => from = middle,
            }
        }
        kept.push(from);
        from += 1;
    }
    Some(kept)
}

fn obeyable(rows: &[Row], chosen: &[usize]) -> bool {
    let rows: Vec<&Row> = chosen.iter().filter_map(|k| rows.get(*k)).collect();
    let mut places = BTreeMap::new();
    for (block, column, _) in rows.iter().flat_map(|r| &r.entries) {
        let next = places.len();
        places.entry((*block, *column)).or_insert(next);
    }
    let n = places.len();
    let scale = rows.iter().map(|r| reach(r)).fold(0.0, f64::max);
    let scale = if scale > 0.0 { scale } else { 1.0 };
    let plane = |row: &Row| {
        let mut weights = vec![0.0; n];
        let largest = largest(row);
        for (block, column, w) in &row.entries {
            if let Some(k) = places.get(&(*block, *column)) {
                weights[*k] += w / largest;
            }
        }
        let strict = if row.sense == Sense::Below {
            STRICT
        } else {
            0.0
        };
        Plane {
            weights,
            right: row.right / largest / scale - strict,
        }
    };
    let of = |equal: bool| -> Vec<Plane> {
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
                .map(|g| if g.abs() < 1e-13 { 0.0 } else { g })
                .collect(),
            height: p.left(&solutions.constant) - p.right,
        })
        .collect();
    least_distance(&spaces).is_some()
}

fn largest(row: &Row) -> f64 {
    let largest = row.entries.iter().fold(0.0_f64, |m, e| m.max(e.2.abs()));
    if largest > 0.0 { largest } else { 1.0 }
}

fn reach(row: &Row) -> f64 {
    row.right.abs() / largest(row)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Sense::{AtMost, Below, Equal};

    fn row(entries: &[(usize, f64)], sense: Sense, right: f64) -> Row {
        Row {
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
        assert_eq!(conflict(&rows), Some(vec![1, 2, 4]));
        assert_eq!(conflict(&rows[..4]), None);
    }

    #[test]
    fn strict_rows_exclude_their_bounds() {
        let twice = |sense| {
            [
                row(&[(0, 1.0)], sense, 2.0),
                row(&[(0, -1.0)], AtMost, -2.0),
            ]
        };
        assert_eq!(conflict(&twice(AtMost)), None);
        assert_eq!(conflict(&twice(Below)), Some(vec![0, 1]));
        let signs = [row(&[(0, 1.0)], Below, 0.0), row(&[(0, -1.0)], Below, 0.0)];
        assert_eq!(conflict(&signs), Some(vec![0, 1]));
    }

    #[test]
    fn values_given_twice_agree_or_not() {
        let given = |a, b| [row(&[(0, 1.0)], Equal, a), row(&[(0, 2.0)], Equal, b)];
        assert_eq!(conflict(&given(0.3, 2.0 * (0.1 + 0.2))), None);
        assert_eq!(conflict(&given(0.3, 0.7)), Some(vec![0, 1]));
        // Nothing is left to choose: 0 = 1.
        assert_eq!(conflict(&[row(&[], Equal, 1.0)]), Some(vec![0]));
        assert_eq!(conflict(&[row(&[], AtMost, 1.0)]), None);
        assert_eq!(conflict(&[row(&[], AtMost, -1.0)]), Some(vec![0]));
        assert_eq!(conflict(&[row(&[], Below, 0.0)]), Some(vec![0]));
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
                assert_eq!(conflict(&between(1.0, 2.0)), None, "{size} {weight}");
                assert_eq!(
                    conflict(&between(2.0, 1.0)),
                    Some(vec![0, 1]),
                    "{size} {weight}"
                );
                let signs = [
                    row(&[(0, weight)], Below, 0.0),
                    row(&[(0, -weight)], Below, 0.0),
                ];
                assert_eq!(conflict(&signs), Some(vec![0, 1]));
            }
        }
        // A place may be named twice: 2 a ≤ 2 and a ≥ 2.
        let twice = [
            row(&[(0, 1.0), (0, 1.0)], AtMost, 2.0),
            row(&[(0, -1.0)], AtMost, -2.0),
        ];
        assert_eq!(conflict(&twice), Some(vec![0, 1]));
    }
}
