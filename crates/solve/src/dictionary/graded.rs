//! Graded columns: weights in the 1-norm that grow beyond the columns' lengths.
//!
//! In: a dictionary, a grade for each factor. Out: the same columns with the weights g_j ‖φ_j‖. Never changes a column.

use super::factored::Block;
use super::operator::Dictionary;
use super::pricing::Priced;
use crate::linalg::norm;

/// Grades g_j > 0: the weight of column j is g_j ‖φ_j‖. The grade of a product is the product of its factors' grades, so a grade is
/// kept for each factor only.
#[derive(Clone, Debug, PartialEq)]
pub struct Grades {
    blocks: Vec<Block>,
    left: Vec<f64>,
    right: Vec<f64>,
}

impl Grades {
    /// Grades of the factors of blocks, as [`super::Factored::new`] takes them. All are positive and finite.
    pub fn of_products(blocks: Vec<Block>, [left, right]: [Vec<f64>; 2]) -> Grades {
        Grades {
            blocks,
            left,
            right,
        }
    }

    /// A grade for each column.
    pub fn of_columns(grades: Vec<f64>) -> Grades {
        let block = Block {
            first_slot: 0,
            left: 0..grades.len(),
            right: 0..1,
        };
        Grades {
            blocks: vec![block],
            left: grades,
            right: vec![1.0],
        }
    }

    /// g_j; 1 past the last column.
    pub fn of(&self, j: usize) -> f64 {
        let after = self.blocks.partition_point(|b| b.first_slot <= j);
        let block = after.checked_sub(1).and_then(|b| self.blocks.get(b));
        let Some(block) = block.filter(|b| j < b.first_slot + b.slots()) else {
            return 1.0;
        };
        let [l, r] = block.factors(j);
        self.left(l) * self.right(r)
    }

    /// The grade of a left factor.
    pub(super) fn left(&self, l: usize) -> f64 {
        self.left.get(l).copied().unwrap_or(1.0)
    }

    /// The grade of a right factor.
    pub(super) fn right(&self, r: usize) -> f64 {
        self.right.get(r).copied().unwrap_or(1.0)
    }

    /// The grades of some right factors.
    pub(super) fn rights(&self, range: std::ops::Range<usize>) -> &[f64] {
        self.right.get(range).unwrap_or_default()
    }

    /// The least grade of all products of some left and some right factors.
    pub(super) fn least(&self, left: std::ops::Range<usize>, right: std::ops::Range<usize>) -> f64 {
        let least = |all: &[f64]| all.iter().copied().fold(f64::INFINITY, f64::min);
        let part = |all: &[f64], range| all.get(range).map_or(1.0, least);
        part(&self.left, left) * part(&self.right, right)
    }
}

/// A dictionary with grades.
#[derive(Clone, Copy)]
pub struct Graded<'a> {
    pub columns: &'a dyn Dictionary,
    pub grades: &'a Grades,
}

impl Dictionary for Graded<'_> {
    fn rows(&self) -> usize {
        self.columns.rows()
    }

    fn cols(&self) -> usize {
        self.columns.cols()
    }

    fn norms(&self) -> &[f64] {
        self.columns.norms()
    }

    fn weight(&self, j: usize) -> f64 {
        self.columns.weight(j) * self.grades.of(j)
    }

    fn column(&self, j: usize, out: &mut [f64]) {
        self.columns.column(j, out);
    }

    fn price(&self, lambda: &[f64], most: usize, bound: f64) -> Priced {
        self.columns.price_graded(self.grades, lambda, most, bound)
    }
}

/// Whether no column of at least this grade can exceed the bound: |φᵀλ| ≤ ‖φ‖‖λ‖.
pub(super) fn within_bound(length: f64, least_grade: f64, bound: f64) -> bool {
    /// More than the rounding of the length and of any correlation.
    const ROUNDING: f64 = 1e-9;
    length * (1.0 + ROUNDING) < bound * least_grade
}

/// ‖λ‖
pub(super) fn length(lambda: &[f64]) -> f64 {
    norm(lambda)
}
