//! Φ as products of columns: every left factor times every right factor of a block, row by row. Φ itself is never stored.
//!
//! In: columns of factors. Out: a [`Dictionary`], computed in tiles that fit the cache of a core. With L and R the factors of a
//! block, Φᵀλ = vec(Rᵀ diag(λ) L) and the squared norms are (R∘R)ᵀ(L∘L): both are matrix products.

use std::ops::Range;

use nalgebra::{DMatrixView, DMatrixViewMut};

use super::block::Block;
use super::grades::Grades;
use super::operator::Dictionary;
use super::pricing::{Priced, PricingCollector};
use crate::linalg::{dot_in_lanes, gemm, is_safe, largest_magnitude, norm, scaled_dot, transposed};
use crate::threads;
use crate::thresholds::PARALLELISM;

/// The matrix of a library of products. It keeps the factors, and one norm for each slot.
#[derive(Clone, Debug)]
pub struct Factored {
    rows: usize,
    /// Left factors of all blocks, column after column, with the rows' weights.
    left: Vec<f64>,
    /// Right factors of all blocks.
    right: Vec<f64>,
    blocks: Vec<Block>,
    /// Zero in empty slots.
    norms: Vec<f64>,
}

/// A column that is not finite: its factors, and its first row at fault.
pub struct NotFinite {
    pub factors: [usize; 2],
    pub row: usize,
}

/// Right columns of a tile.
const TILE_RIGHT: usize = 256;
/// Most left columns of a tile: its products take 256 KiB, its left factors 300 KiB at 300 rows; half as many cost a tenth more,
/// because the right factors are packed anew for every tile.
const TILE_MAX_LEFT: usize = 128;
/// Fewest left columns of a tile.
const TILE_MIN_LEFT: usize = 8;
/// Numbers that the left factors of a tile may hold, unless that are fewer than the fewest columns.
const TILE_LEFT_NUMBERS: usize = 1 << 20;
/// A tile with fewer columns is computed by dot products: a matrix product would reuse nothing.
const TILE_MIN_PRODUCT: usize = 4;

/// Left columns of one block with all its right ones: consecutive slots.
struct Task<'a> {
    block: &'a Block,
    left: Range<usize>,
}

impl Factored {
    /// From the left and right factors, and their blocks in slot order without empty ones. `empty` lists, rising, the slots that
    /// hold no term.
    ///
    /// # Errors
    /// The first column, not in an empty slot, that is not finite.
    pub fn new(
        rows: usize,
        [left, right]: [Vec<f64>; 2],
        blocks: Vec<Block>,
        empty: &[usize],
    ) -> Result<Factored, NotFinite> {
        let slots = blocks.iter().map(Block::slots).sum();
        let mut factored = Factored {
            rows,
            left,
            right,
            blocks,
            norms: Vec::new(),
        };
        let mut norms = vec![0.0; slots];
        let measured = factored.measure(factored.threads(), empty, &mut norms);
        measured.map_err(|slot| factored.not_finite(slot))?;
        for slot in empty {
            norms[*slot] = 0.0;
        }
        factored.norms = norms;
        Ok(factored)
    }

    /// ‖φ_j‖ of every slot; what stands in empty ones is undefined.
    fn measure(&self, threads: usize, empty: &[usize], norms: &mut [f64]) -> Result<(), usize> {
        let scales = [&self.left, &self.right].map(|f| self.scales(f));
        let squares = self.scaled_squares(&scales[1]);
        let mut rest = norms;
        let tasks = self.tasks().map(|task| {
            let norms = rest.split_off_mut(..task.slots().len()).unwrap_or_default();
            (task, norms)
        });
        let first_bad = threads::share(threads, tasks, |mut tasks| {
            let measure = |(task, norms)| self.measure_task(&task, &scales, &squares, empty, norms);
            Iterator::find_map(&mut tasks, measure)
        });
        first_bad.into_iter().flatten().min().map_or(Ok(()), Err)
    }

    /// Norms of the slots of one task, or the first slot that is not finite.
    fn measure_task(
        &self,
        task: &Task,
        [left_scales, right_scales]: &[Vec<f64>; 2],
        right_squares: &[f64],
        empty: &[usize],
        norms: &mut [f64],
    ) -> Option<usize> {
        let square = |l: usize, column: &[f64], out: &mut [f64]| {
            let scaled = column.iter().map(|x| x / left_scales[l]);
            out.iter_mut().zip(scaled).for_each(|(o, x)| *o = x * x);
        };
        let mut bad = None;
        let all = |_: Range<usize>, _: Range<usize>| true;
        self.products(task, right_squares, all, square, |l, right, squares| {
            let slot = task.block.slot(l, right.start);
            let norms = &mut norms[slot - task.slots().start..][..squares.len()];
            let scales = &right_scales[right];
            if !roots(squares, left_scales[l], scales, norms) {
                let found = self.measure_exactly(slot, squares, empty, norms);
                bad = bad.into_iter().chain(found).min();
            }
        });
        bad
    }

    /// Exact norms of those columns whose sum of squares overflowed or underflowed. The first slot that is not finite, if any.
    fn measure_exactly(
        &self,
        first: usize,
        squares: &[f64],
        empty: &[usize],
        norms: &mut [f64],
    ) -> Option<usize> {
        let mut column = vec![0.0; self.rows];
        let mut bad = None;
        for (slot, (square, length)) in (first..).zip(squares.iter().zip(norms)) {
            if is_safe(*square) && is_safe(*length) || empty.binary_search(&slot).is_ok() {
                continue;
            }
            self.product(slot, &mut column);
            *length = norm(&column);
            if bad.is_none() && column.iter().any(|x| !x.is_finite()) {
                bad = Some(slot);
            }
        }
        bad
    }

    /// A power of two near the largest entry of each column; divided by it, no square overflows.
    fn scales(&self, factors: &[f64]) -> Vec<f64> {
        // The exponent bits alone. Zero, denormal and non-finite columns get a scale that makes the sum of squares unsafe.
        let exponent = |x: f64| f64::from_bits(x.to_bits() & f64::INFINITY.to_bits());
        let columns = factors.chunks_exact(self.rows.max(1));
        columns.map(|c| exponent(largest_magnitude(c))).collect()
    }

    /// The squares of the right factors over their scales.
    fn scaled_squares(&self, scales: &[f64]) -> Vec<f64> {
        let mut squares = self.right.clone();
        let columns = squares.chunks_exact_mut(self.rows.max(1)).zip(scales);
        for (column, scale) in columns {
            column.iter_mut().for_each(|x| *x = (*x / scale).powi(2));
        }
        squares
    }

    /// Prices all columns. Tiles whose grades alone keep them within the bound are not computed.
    pub(super) fn price_on(
        &self,
        threads: usize,
        grades: Option<&Grades>,
        lambda: &[f64],
        (most, bound): (usize, f64),
    ) -> Priced {
        let graded = |l: usize| grades.map_or(1.0, |g| g.left(l));
        let price = |l: usize, column: &[f64], out: &mut [f64]| {
            let grade = 1.0 / graded(l);
            let priced = column.iter().zip(lambda).map(|(x, l)| x * (l * grade));
            out.iter_mut().zip(priced).for_each(|(o, p)| *o = p);
        };
        let size = norm(lambda);
        let wanted = |left: Range<usize>, right: Range<usize>| {
            grades.is_none_or(|g| !g.dismiss(left, right, size, bound))
        };
        let collectors = threads::share(threads, self.tasks(), |tasks| {
            let mut found = PricingCollector::new(most, bound);
            for task in tasks {
                self.products(&task, &self.right, wanted, price, |l, right, products| {
                    let slot = task.block.slot(l, right.start);
                    let norms = &self.norms[slot..slot + products.len()];
                    // No early exit, so that the loop is vectorised.
                    if !products.iter().fold(true, |all, p| all & p.is_finite()) {
                        let slots = slot..slot + products.len();
                        return self.offer_scaled(slots, grades, lambda, &mut found);
                    }
                    if let Some(grades) = grades {
                        let rights = grades.rights(right);
                        products.iter_mut().zip(rights).for_each(|(p, g)| *p /= g);
                    }
                    found.offer_all(slot, products, norms);
                });
            }
            found
        });
        PricingCollector::finish_all(collectors)
    }

    /// Prices columns again as columns of length one, where a product overflowed.
    fn offer_scaled(
        &self,
        slots: Range<usize>,
        grades: Option<&Grades>,
        lambda: &[f64],
        found: &mut PricingCollector,
    ) {
        let mut column = vec![0.0; self.rows];
        for slot in slots.filter(|slot| self.norms[*slot] > 0.0) {
            self.product(slot, &mut column);
            let grade = grades.map_or(1.0, |g| g.of(slot));
            found.offer(slot, scaled_dot(&column, self.norms[slot], lambda) / grade);
        }
    }

    /// `Rᵀ prepare(L)` for a task, in tiles that are `wanted`: `visit` gets a left column, some right columns and their products.
    /// Tiles do not depend on the number of threads, so the digits do not either.
    fn products(
        &self,
        task: &Task,
        right: &[f64],
        wanted: impl Fn(Range<usize>, Range<usize>) -> bool,
        prepare: impl Fn(usize, &[f64], &mut [f64]),
        mut visit: impl FnMut(usize, Range<usize>, &mut [f64]),
    ) {
        let rows = self.rows.max(1);
        let (width, height) = (self.left_columns(), TILE_RIGHT.min(task.block.right.len()));
        let mut prepared = vec![0.0; rows * width.min(task.left.len())];
        let mut tile = vec![0.0; height * width.min(task.left.len())];
        for lefts in pieces(task.left.clone(), width) {
            if !wanted(lefts.clone(), task.block.right.clone()) {
                continue;
            }
            let prepared = &mut prepared[..rows * lefts.len()];
            for (l, out) in lefts.clone().zip(prepared.chunks_exact_mut(rows)) {
                prepare(l, &self.left[l * rows..(l + 1) * rows], out);
            }
            let tiles = pieces(task.block.right.clone(), TILE_RIGHT);
            for rights in tiles.filter(|rights| wanted(lefts.clone(), rights.clone())) {
                let tile = &mut tile[..rights.len() * lefts.len()];
                let right = &right[rights.start * rows..rights.end * rows];
                multiply(right, prepared, rows, tile);
                for (l, products) in lefts.clone().zip(tile.chunks_exact_mut(rights.len())) {
                    visit(l, rights.clone(), products);
                }
            }
        }
    }

    fn tasks(&self) -> impl Iterator<Item = Task<'_>> {
        self.blocks.iter().flat_map(|block| {
            let width = self.left_columns();
            let tiles = PARALLELISM.factored_task / (width * block.right.len() * self.rows).max(1);
            let lefts = pieces(block.left.clone(), width * tiles.max(1));
            lefts.map(move |left| Task { block, left })
        })
    }

    /// Left columns of a tile.
    fn left_columns(&self) -> usize {
        (TILE_LEFT_NUMBERS / self.rows.max(1)).clamp(TILE_MIN_LEFT, TILE_MAX_LEFT)
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
}

impl Dictionary for Factored {
    fn rows(&self) -> usize {
        self.rows
    }

    fn cols(&self) -> usize {
        self.norms.len()
    }

    fn norms(&self) -> &[f64] {
        &self.norms
    }

    fn column(&self, j: usize, out: &mut [f64]) {
        if self.norms[j] == 0.0 {
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

impl Task<'_> {
    fn slots(&self) -> Range<usize> {
        let (first, end) = (self.left.start, self.left.end);
        let start = self.block.slot(first, self.block.right.start);
        start..start + (end - first) * self.block.right.len()
    }
}

/// A range in pieces of `size`, the last one shorter.
fn pieces(range: Range<usize>, size: usize) -> impl Iterator<Item = Range<usize>> {
    let end = range.end;
    range.step_by(size).map(move |s| s..end.min(s + size))
}

/// Norms from scaled sums of squares; false if one of them is unsafe.
fn roots(squares: &[f64], left_scale: f64, right_scales: &[f64], norms: &mut [f64]) -> bool {
    let mut safe = true;
    for ((norm, square), scale) in norms.iter_mut().zip(squares).zip(right_scales) {
        *norm = square.sqrt() * (left_scale * scale);
        safe &= is_safe(*square) & is_safe(*norm);
    }
    safe
}

/// Rᵀ L, both of `rows` rows, into `out`, whose columns are those of L.
fn multiply(right: &[f64], left: &[f64], rows: usize, out: &mut [f64]) {
    let (height, width) = (right.len() / rows, left.len() / rows);
    if height.min(width) < TILE_MIN_PRODUCT {
        let columns = out.chunks_exact_mut(height).zip(left.chunks_exact(rows));
        for (out, left) in columns {
            let products = right
                .chunks_exact(rows)
                .map(|right| dot_in_lanes::<8>(left, right));
            out.iter_mut().zip(products).for_each(|(o, p)| *o = p);
        }
        return;
    }
    gemm(
        1.0,
        &transposed(right, rows, height),
        &DMatrixView::from_slice(left, rows, width),
        0.0,
        DMatrixViewMut::from_slice(out, height, width),
    );
}

#[cfg(test)]
mod tests;
