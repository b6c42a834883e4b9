//! The working set: columns of a dictionary over their weights, contiguous in memory.
//!
//! In: column indices. Out: a dense M × w matrix to iterate on. Columns are never removed: removing inactive ones cycles, because
//! the dual optimum is not unique when the support is small.

use std::collections::BTreeSet;

use crate::dictionary::Dictionary;
use crate::linalg::gemv_tr;

/// w columns of a dictionary, each over its weight: unit columns, or shorter ones where columns are graded.
pub(super) struct WorkingSet<'a> {
    dictionary: &'a dyn Dictionary,
    /// Column-major, M · w.
    values: Vec<f64>,
    columns: Vec<usize>,
    members: BTreeSet<usize>,
}

impl<'a> WorkingSet<'a> {
    pub fn new(dictionary: &'a dyn Dictionary) -> WorkingSet<'a> {
        WorkingSet {
            dictionary,
            values: Vec::new(),
            columns: Vec::new(),
            members: BTreeSet::new(),
        }
    }

    /// Adds columns in the order given, except members and columns of length zero. Returns how many were added.
    pub fn add(&mut self, columns: impl IntoIterator<Item = usize>) -> usize {
        let rows = self.dictionary.rows();
        let before = self.columns.len();
        for j in columns {
            let weight = self.dictionary.weight(j);
            if weight > 0.0 && self.members.insert(j) {
                let start = self.values.len();
                self.values.resize(start + rows, 0.0);
                let column = &mut self.values[start..];
                self.dictionary.column(j, column);
                column.iter_mut().for_each(|x| *x /= weight);
                self.columns.push(j);
            }
        }
        self.columns.len() - before
    }

    pub fn contains(&self, column: usize) -> bool {
        self.members.contains(&column)
    }

    /// w
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Index in the dictionary of the k-th column.
    pub fn index(&self, k: usize) -> Option<usize> {
        self.columns.get(k).copied()
    }

    /// The k-th unit column.
    pub fn column(&self, k: usize) -> &[f64] {
        let rows = self.dictionary.rows();
        &self.values[k * rows..(k + 1) * rows]
    }

    /// The unit columns from the k-th on, one after another.
    pub fn columns_from(&self, k: usize) -> &[f64] {
        &self.values[k * self.dictionary.rows()..]
    }

    /// Pᵀv
    pub fn correlations(&self, v: &[f64]) -> Vec<f64> {
        gemv_tr(&self.values, self.dictionary.rows(), v)
    }

    /// Coefficients of the raw columns, by rising column, from (place in the working set, coefficient of the unit column).
    pub fn raw(&self, unit: &[(usize, f64)], target_norm: f64) -> Vec<(usize, f64)> {
        let raw = unit.iter().map(|(k, x)| {
            let j = self.columns[*k];
            (j, x * target_norm / self.dictionary.weight(j))
        });
        let mut raw: Vec<(usize, f64)> = raw.filter(|(_, a)| a.is_finite() && *a != 0.0).collect();
        raw.sort_unstable_by_key(|(j, _)| *j);
        raw
    }
}
