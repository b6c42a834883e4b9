//! Linear constraints on the coefficients of a system, and what they ask of a support.
//!
//! In: rows over the columns of a system, a support. Out: the rows on the support, its closure, how many of its coefficients are free.
//! Never sees data. A column off the support has the coefficient zero.

use sidc_solve::{LinearConstraint, Sense, solution_space};

/// Constraints of a system; the columns of their entries are places among its columns, all in block 0.
#[derive(Clone, Debug, Default)]
pub struct CoefficientConstraints {
    pub rows: Vec<LinearConstraint>,
    /// For each row, which statement of the model it is.
    pub stated: Vec<usize>,
    /// Columns that every support has, whatever their coefficients.
    pub required: Vec<usize>,
}

impl CoefficientConstraints {
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty() && self.required.is_empty()
    }

    /// The same without rows: what is required stays so.
    pub(crate) fn without_rows(&self) -> Self {
        CoefficientConstraints {
            required: self.required.clone(),
            ..CoefficientConstraints::default()
        }
    }

    /// Whether a support has every column that is required.
    pub(crate) fn has_required(&self, support: &[usize]) -> bool {
        self.required.iter().all(|j| support.contains(j))
    }

    /// The rows with places in the support for columns.
    pub(crate) fn on(&self, support: &[usize]) -> Vec<LinearConstraint> {
        let place = |column: usize| support.iter().position(|j| *j == column);
        self.renumbered(&place).rows
    }

    /// The rows with other numbers for the columns; those without a number have the coefficient zero.
    pub(crate) fn renumbered(&self, place: &dyn Fn(usize) -> Option<usize>) -> Self {
        let row = |row: &LinearConstraint| {
            let entries = row.entries.iter();
            let kept = entries.filter_map(|(b, j, w)| Some((*b, place(*j)?, *w)));
            LinearConstraint {
                entries: kept.collect(),
                ..row.clone()
            }
        };
        CoefficientConstraints {
            rows: self.rows.iter().map(row).collect(),
            stated: self.stated.clone(),
            required: self.required.iter().filter_map(|j| place(*j)).collect(),
        }
    }

    /// Free coefficients of a support: an equation that ties or fixes some of them takes one away.
    pub(crate) fn free_coefficients(&self, support: &[usize]) -> usize {
        if self.rows.iter().all(|r| r.sense != Sense::Equal) {
            return support.len();
        }
        let rows = self.on(support);
        let equations = rows.iter().filter(|r| r.sense == Sense::Equal);
        solution_space(support.len(), equations).map_or(support.len(), |s| s.matrix.ncols())
    }

    /// Whether the coefficients of a support obey every row, to rounding.
    pub(crate) fn hold(&self, support: &[usize], coefficients: &[f64]) -> bool {
        let coefficient = |_: usize, column: usize| {
            let place = support.iter().position(|j| *j == column);
            place.map_or(0.0, |k| coefficients[k])
        };
        self.has_required(support) && self.rows.iter().all(|r| r.holds(&coefficient))
    }

    /// The closure of a support: with every column that an equation ties to a chosen one, and with the columns of every row that
    /// coefficients of zero, or these coefficients of the support, break. Rising.
    pub(crate) fn closure(&self, support: &[usize], coefficients: &[f64]) -> Vec<usize> {
        let start = support;
        let mut closed = support.to_vec();
        closed.extend_from_slice(&self.required);
        closed.sort_unstable();
        closed.dedup();
        let value = |_: usize, column: usize| {
            let place = start.iter().position(|j| *j == column);
            place.map_or(0.0, |k| coefficients[k])
        };
        loop {
            let before = closed.len();
            for row in &self.rows {
                let chosen = row.entries.iter().any(|(_, j, _)| closed.contains(j));
                let needed = match row.sense {
                    Sense::Equal => row.right != 0.0 || chosen,
                    Sense::AtMost | Sense::Below => row.right < 0.0 || chosen && !row.holds(&value),
                };
                for (_, column, _) in row.entries.iter().filter(|_| needed) {
                    if let Err(place) = closed.binary_search(column) {
                        closed.insert(place, *column);
                    }
                }
            }
            if closed.len() == before {
                return closed;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(entries: &[(usize, f64)], sense: Sense, right: f64) -> LinearConstraint {
        LinearConstraint {
            entries: entries.iter().map(|(j, w)| (0, *j, *w)).collect(),
            sense,
            right,
        }
    }

    fn constraints(rows: &[LinearConstraint]) -> CoefficientConstraints {
        CoefficientConstraints {
            rows: rows.to_vec(),
            stated: (0..rows.len()).collect(),
            required: Vec::new(),
        }
    }

    #[test]
    fn what_is_required_is_in_every_support() {
        let of = CoefficientConstraints {
            required: vec![2, 6],
            ..constraints(&[row(&[(6, 1.0), (8, 1.0)], Sense::Equal, 0.0)])
        };
        assert!(!of.is_empty() && !of.without_rows().is_empty());
        assert_eq!(of.closure(&[4], &[1.0]), [2, 4, 6, 8]);
        assert!(!of.hold(&[6, 8], &[1.0, -1.0]) && of.hold(&[2, 6, 8], &[0.3, 1.0, -1.0]));
        assert_eq!(of.renumbered(&|j| (j != 2).then_some(j + 1)).required, [7]);
    }

    #[test]
    fn tied_terms_come_in_together_and_count_once() {
        let tied = constraints(&[
            row(&[(1, 1.0), (5, 1.0)], Sense::Equal, 0.0),
            row(&[(5, 2.0), (7, 1.0)], Sense::Equal, 0.0),
        ]);
        assert_eq!(tied.closure(&[5], &[3.0]), [1, 5, 7]);
        assert_eq!(tied.closure(&[2], &[3.0]), [2]);
        assert_eq!(tied.free_coefficients(&[1, 2, 5, 7]), 2);
        // A tied term alone can only be zero.
        assert_eq!(tied.free_coefficients(&[2, 7]), 1);
        assert!(tied.hold(&[1, 5, 7], &[1.0, -1.0, 2.0]));
        assert!(!tied.hold(&[1, 5], &[1.0, -1.0]));
    }

    #[test]
    fn a_value_comes_in_and_costs_nothing() {
        let fixed = constraints(&[row(&[(3, 1.0)], Sense::Equal, 0.7)]);
        assert_eq!(fixed.closure(&[], &[]), [3]);
        assert_eq!(fixed.free_coefficients(&[0, 3]), 1);
        assert!(!fixed.hold(&[0], &[1.0]) && fixed.hold(&[0, 3], &[1.0, 0.7]));
    }

    #[test]
    fn what_a_bound_needs_comes_in() {
        // a₂ ≥ 0.5; a₄ ≤ a₆; a₈ ≥ 0
        let bounds = constraints(&[
            row(&[(2, -1.0)], Sense::AtMost, -0.5),
            row(&[(4, 1.0), (6, -1.0)], Sense::AtMost, 0.0),
            row(&[(8, -1.0)], Sense::Below, 0.0),
        ]);
        assert_eq!(bounds.closure(&[8], &[-1.0]), [2, 8]);
        assert_eq!(bounds.closure(&[4], &[-1.0]), [2, 4]);
        assert_eq!(bounds.closure(&[4], &[1.0]), [2, 4, 6]);
        assert_eq!(bounds.free_coefficients(&[2, 4, 8]), 3);
    }

    #[test]
    fn rows_follow_their_columns() {
        let tied = constraints(&[row(&[(1, 1.0), (5, -1.0)], Sense::Equal, 0.0)]);
        let moved = tied.renumbered(&|j| (j != 1).then_some(j + 10));
        assert_eq!(moved.rows[0].entries, [(0, 15, -1.0)]);
        assert_eq!(tied.on(&[5, 9, 1])[0].entries, [(0, 2, 1.0), (0, 0, -1.0)]);
    }
}
