//! Products of all left and right factors, in tiles that fit the cache of a core, in single or double precision.
//!
//! In: right factors over their scales, and a rule that prepares a left one. Out: the products of each left factor, to a visitor. Knows
//! neither lengths nor bounds. Both kinds of factors are laid out row after row within a tile, as the matrix product wants them.

use std::ops::Range;

use nalgebra::{DMatrixViewMut, RealField};

use super::Factored;
use crate::dictionary::block::Block;
use crate::linalg::{Strided, gemm, largest_magnitude};
use crate::thresholds::PARALLELISM;

/// Right columns of a tile.
const TILE_RIGHT: usize = 256;
/// Most left columns of a tile: its products take 256 KiB in single precision; half as many cost a tenth more, because the right factors
/// are packed anew for every tile.
const TILE_MAX_LEFT: usize = 256;
/// Fewest left columns of a tile.
const TILE_MIN_LEFT: usize = 8;
/// Numbers that the left factors of a tile may hold, unless that are fewer than the fewest columns.
const TILE_LEFT_NUMBERS: usize = 1 << 20;
/// A tile with fewer columns is computed row by row: a matrix product would reuse nothing.
const TILE_MIN_PRODUCT: usize = 4;
/// Rows that are summed at once: rounding grows with these and with the number of such sums.
const ROWS_AT_ONCE: usize = 1024;

/// A precision.
pub(super) trait Scaled: RealField + Copy {
    /// Rounded to this precision.
    fn of(x: f64) -> Self;
    fn to_double(self) -> f64;
    /// Half the distance from 1 to the next number.
    const ROUNDOFF: f64;
}

impl Scaled for f32 {
    const ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;

    #[inline(always)]
    fn of(x: f64) -> f32 {
        x as f32
    }

    #[inline(always)]
    fn to_double(self) -> f64 {
        f64::from(self)
    }
}

impl Scaled for f64 {
    const ROUNDOFF: f64 = f64::EPSILON / 2.0;

    #[inline(always)]
    fn of(x: f64) -> f64 {
        x
    }

    #[inline(always)]
    fn to_double(self) -> f64 {
        self
    }
}

/// Left columns of one block with all its right ones: consecutive slots.
pub(super) struct Task<'a> {
    pub block: &'a Block,
    pub left: Range<usize>,
}

impl Task<'_> {
    pub fn slots(&self) -> Range<usize> {
        let (first, end) = (self.left.start, self.left.end);
        let start = self.block.slot(first, self.block.right.start);
        start..start + (end - first) * self.block.right.len()
    }
}

impl Factored {
    /// The factors with their scales, and no lengths yet.
    pub(super) fn unmeasured(
        rows: usize,
        [left, right]: [Vec<f64>; 2],
        blocks: Vec<Block>,
    ) -> Factored {
        let scales = [&left, &right].map(|factors| scales(factors, rows));
        Factored {
            rows,
            scaled_right: scaled(&right, &scales[1], rows, &blocks),
            left,
            right,
            scales,
            blocks,
            lengths: Vec::new(),
            is_finite: true,
        }
    }

    /// `Rᵀ prepare(L)` for a task, in tiles that are `wanted`: `visit` gets a left column, some right columns and their products, until it
    /// returns false. `right`: as [`Factored::scaled_right`]; `prepare` writes a left column in this precision.
    pub(super) fn products<T: Scaled>(
        &self,
        task: &Task,
        right: &[T],
        wanted: impl Fn(Range<usize>, Range<usize>) -> bool,
        prepare: impl Fn(usize, &[f64], &mut [T]),
        mut visit: impl FnMut(usize, Range<usize>, &[T]) -> bool,
    ) -> bool {
        let rows = self.rows.max(1);
        let (width, height) = (self.left_columns(), TILE_RIGHT.min(task.block.right.len()));
        let mut prepared = vec![T::zero(); rows * width.min(task.left.len())];
        let mut tile = vec![T::zero(); height * width.min(task.left.len())];
        let mut column = vec![T::zero(); rows];
        for lefts in pieces(task.left.clone(), width) {
            if !wanted(lefts.clone(), task.block.right.clone()) {
                continue;
            }
            let (prepared, count) = (&mut prepared[..rows * lefts.len()], lefts.len());
            for (at, l) in lefts.clone().enumerate() {
                prepare(l, &self.left[l * rows..(l + 1) * rows], &mut column);
                place_column(at, &column, prepared, count);
            }
            let tiles = pieces(task.block.right.clone(), TILE_RIGHT);
            for rights in tiles.filter(|rights| wanted(lefts.clone(), rights.clone())) {
                let tile = &mut tile[..rights.len() * lefts.len()];
                let right = &right[rights.start * rows..rights.end * rows];
                multiply(right, prepared, rows, tile);
                let mut columns = lefts.clone().zip(tile.chunks_exact(rights.len()));
                if !columns.all(|(l, products)| visit(l, rights.clone(), products)) {
                    return false;
                }
            }
        }
        true
    }

    pub(super) fn tasks(&self) -> impl Iterator<Item = Task<'_>> {
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
}

/// Terms that a rounding error of one product of columns may add up from.
pub(super) fn depth(rows: usize) -> usize {
    rows.min(ROWS_AT_ONCE) + rows / ROWS_AT_ONCE
}

/// A power of two near the largest entry of each column; zero or infinite for columns whose entries cannot be scaled: of zeros, of denormal
/// numbers, or not finite.
fn scales(factors: &[f64], rows: usize) -> Vec<f64> {
    let columns = factors.chunks_exact(rows.max(1));
    columns
        .map(|c| power_of_two(largest_magnitude(c)))
        .collect()
}

/// The largest power of two that is no larger than `x` ≥ 0: its exponent bits alone. Zero for zero and denormal numbers, infinite for what
/// is not finite.
pub(super) fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & f64::INFINITY.to_bits())
}

/// Right factors of all blocks over their scales, row after row within a tile.
pub(super) fn scaled<T: Scaled>(
    factors: &[f64],
    scales: &[f64],
    rows: usize,
    blocks: &[Block],
) -> Vec<T> {
    let mut out = vec![T::zero(); factors.len()];
    let mut scaled = Vec::with_capacity(rows);
    for rights in blocks
        .iter()
        .flat_map(|b| pieces(b.right.clone(), TILE_RIGHT))
    {
        let tile = &mut out[rights.start * rows..rights.end * rows];
        let count = rights.len();
        for (at, r) in rights.enumerate() {
            let column = &factors[r * rows..(r + 1) * rows];
            let inverse = 1.0 / scales[r];
            scaled.clear();
            scaled.extend(column.iter().map(|x| T::of(x * inverse)));
            place_column(at, &scaled, tile, count);
        }
    }
    out
}

/// Writes a column into a tile of `count` columns that is laid out row after row.
fn place_column<T: Copy>(at: usize, column: &[T], tile: &mut [T], count: usize) {
    for (row, x) in tile.chunks_exact_mut(count).zip(column) {
        if let Some(entry) = row.get_mut(at) {
            *entry = *x;
        }
    }
}

/// A range in pieces of `size`, the last one shorter.
fn pieces(range: Range<usize>, size: usize) -> impl Iterator<Item = Range<usize>> {
    let end = range.end;
    range.step_by(size).map(move |s| s..end.min(s + size))
}

/// Rᵀ L, both row after row, into `out`, whose columns are those of L.
fn multiply<T: Scaled>(right: &[T], left: &[T], rows: usize, out: &mut [T]) {
    let (height, width) = (right.len() / rows, left.len() / rows);
    if height.min(width) < TILE_MIN_PRODUCT {
        return multiply_few((right, height), (left, width), out);
    }
    let mut out = DMatrixViewMut::from_slice(out, height, width);
    for part in pieces(0..rows, ROWS_AT_ONCE) {
        let kept = if part.start == 0 { T::zero() } else { T::one() };
        let right = &right[part.start * height..part.end * height];
        let left = &left[part.start * width..part.end * width];
        let right = Strided::<T>::from_slice_with_strides(right, height, part.len(), 1, height);
        let left = Strided::<T>::from_slice_with_strides(left, part.len(), width, width, 1);
        gemm(T::one(), &right, &left, kept, out.as_view_mut());
    }
}

/// The same row by row, for few columns on one side; the longer side is the inner loop.
fn multiply_few<T: Scaled>(
    (right, height): (&[T], usize),
    (left, width): (&[T], usize),
    out: &mut [T],
) {
    let (few, many) = if height < width {
        ((right, height), (left, width))
    } else {
        ((left, width), (right, height))
    };
    let mut sums = vec![0.0; out.len()];
    for (few, many) in few.0.chunks_exact(few.1).zip(many.0.chunks_exact(many.1)) {
        for (sums, x) in sums.chunks_exact_mut(many.len()).zip(few) {
            let x = x.to_double();
            sums.iter_mut()
                .zip(many)
                .for_each(|(sum, y)| *sum += x * y.to_double());
        }
    }
    for (at, sum) in sums.into_iter().enumerate() {
        let (slow, fast) = (at / many.1, at % many.1);
        let place = if height < width {
            fast * height + slow
        } else {
            at
        };
        out[place] = T::of(sum);
    }
}
