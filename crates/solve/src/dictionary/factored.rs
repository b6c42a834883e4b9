//! Φ as products of columns: every left factor times every right factor of a block, row by row. Φ itself is never stored.
//!
//! In: columns of factors. Out: a [`Dictionary`], computed in tiles that fit the cache of a core. With L and R the factors of a
//! block, Φᵀλ = vec(Rᵀ diag(λ) L) and the squared norms are (R∘R)ᵀ(L∘L): both are matrix products.
//!
//! Both products are in single precision, of factors that are scaled by powers of two. Their bound on rounding tells almost every column
//! from those that a solver asks for; only what it leaves open is computed in double precision, column by column. So every number that
//! leaves this module is of double precision, and pricing takes half the time and half the memory.

use super::block::Block;
use super::grades::Grades;
use super::operator::Dictionary;
use super::pricing::Priced;
use crate::linalg::{dot_in_lanes, norm_from_squares};
use crate::simd::wide;
use crate::threads;

use length::Length;

mod length;
mod lengths;
mod rounding;
mod screening;
mod tiles;

/// Numbers that are added up, or compared, side by side.
const LANES: usize = 16;

/// The matrix of a library of products. It keeps the factors, and one length for each slot.
#[derive(Clone, Debug)]
pub struct Factored {
    rows: usize,
    /// Left factors of all blocks, column after column, with the rows' weights.
    left: Vec<f64>,
    /// Right factors of all blocks.
    right: Vec<f64>,
    /// A power of two near the largest entry of each factor.
    scales: [Vec<f64>; 2],
    /// Right factors over their scales, row after row within a tile.
    scaled_right: Vec<f32>,
    blocks: Vec<Block>,
    /// ‖φ_j‖ over the scales of its factors, to the rounding of [`rounding::Rounding`].
    lengths: Vec<Length>,
    /// Whether every norm is a number.
    is_finite: bool,
}

/// A column that is not finite: its factors, and its first row at fault.
pub struct NotFinite {
    pub factors: [usize; 2],
    pub row: usize,
}

impl Factored {
    /// From the left and right factors, and their blocks in slot order without empty ones. `empty` lists, rising, the slots that
    /// hold no term.
    ///
    /// # Errors
    /// The first column, not in an empty slot, that is not finite.
    pub fn new(
        rows: usize,
        factors: [Vec<f64>; 2],
        blocks: Vec<Block>,
        empty: &[usize],
    ) -> Result<Factored, NotFinite> {
        let mut factored = Factored::unmeasured(rows, factors, blocks);
        let mut lengths = vec![Length::UNKNOWN; factored.blocks.iter().map(Block::slots).sum()];
        let measured = factored.measure(factored.threads(), empty, &mut lengths);
        let is_finite = measured.map_err(|slot| factored.not_finite(slot))?;
        for slot in empty {
            lengths[*slot] = Length::NONE;
        }
        factored.lengths = lengths;
        factored.is_finite = is_finite;
        Ok(factored)
    }

    fn not_finite(&self, slot: usize) -> NotFinite {
        let mut column = vec![0.0; self.rows];
        self.product(slot, &mut column);
        NotFinite {
            factors: self.factors(slot),
            row: column.iter().position(|x| !x.is_finite()).unwrap_or(0),
        }
    }

    fn threads(&self) -> usize {
        let slots: usize = self.blocks.iter().map(Block::slots).sum();
        // Matrix products multiply several times faster than memory is read.
        threads::threads_for(slots.saturating_mul(self.rows) / 4)
    }

    /// The left and the right column of a slot.
    fn factors(&self, slot: usize) -> [usize; 2] {
        let after = self.blocks.partition_point(|b| b.first_slot <= slot);
        self.blocks[after - 1].factors(slot)
    }

    /// The column of a slot, empty or not.
    fn product(&self, slot: usize, out: &mut [f64]) {
        let [l, r] = self.factors(slot).map(|f| f * self.rows);
        let factors = self.left[l..l + self.rows].iter().zip(&self.right[r..]);
        out.iter_mut()
            .zip(factors)
            .for_each(|(o, (l, r))| *o = l * r);
    }

    fn is_empty(&self, slot: usize) -> bool {
        self.lengths[slot] == Length::NONE
    }
}

/// ‖v‖₂
fn column_norm(v: &[f64]) -> f64 {
    norm_from_squares(wide(|| dot_in_lanes::<LANES, f64>(v, v)), v)
}

impl Dictionary for Factored {
    fn rows(&self) -> usize {
        self.rows
    }

    fn cols(&self) -> usize {
        self.lengths.len()
    }

    fn norm(&self, j: usize) -> f64 {
        if j >= self.cols() {
            return 0.0;
        }
        let mut column = vec![0.0; self.rows];
        self.column(j, &mut column);
        column_norm(&column)
    }

    fn is_finite(&self) -> bool {
        self.is_finite
    }

    fn column(&self, j: usize, out: &mut [f64]) {
        if self.is_empty(j) {
            // What the factors of an empty slot give need not be finite.
            return out.fill(0.0);
        }
        self.product(j, out);
    }

    fn price(&self, lambda: &[f64], most: usize, bound: f64) -> Priced {
        self.price_on(self.threads(), None, lambda, (most, bound))
    }

    fn price_graded(&self, grades: &Grades, lambda: &[f64], most: usize, bound: f64) -> Priced {
        self.price_on(self.threads(), Some(grades), lambda, (most, bound))
    }
}

#[cfg(test)]
mod tests;
