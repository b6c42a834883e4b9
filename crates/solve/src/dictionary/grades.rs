//! Grades: by how much the weight of a column in the 1-norm exceeds its length.
//!
//! In: a grade for each factor. Out: that of a column, and whether grades alone keep a tile of columns within a bound.

use std::ops::Range;

use super::block::Block;

/// More than the rounding of a length and of any correlation.
const ROUNDING: f64 = 1e-9;

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

    /// Whether no product of some left and some right factors can have |φᵀλ|/w above the bound, since |φᵀλ| ≤ ‖φ‖‖λ‖. `length` is ‖λ‖.
    pub(super) fn dismiss(
        &self,
        left: Range<usize>,
        right: Range<usize>,
        length: f64,
        bound: f64,
    ) -> bool {
        let least = |all: &[f64]| all.iter().copied().fold(f64::INFINITY, f64::min);
        let part = |all: &[f64], range| all.get(range).map_or(1.0, least);
        let grade = part(&self.left, left) * part(&self.right, right);
        length * (1.0 + ROUNDING) < bound * grade
    }
}
