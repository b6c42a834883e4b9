//! The Gram matrix of unit columns, which holds their cosines: rank, coherence, condition.
//!
//! In: unit columns. Out: figures. Inner products carry half the digits of the columns, so relations found here are measured
//! again on the columns themselves.

use std::ops::Range;

use nalgebra::{DMatrix, DMatrixView};

use crate::identifiability::thresholds::RANK;
use crate::scaled_design::ScaledDesign;
use sidc_solve::linalg::{self, Qr, add_products, transposed};
use sidc_solve::threads;

/// Rows multiplied at once: they stay in a core's cache.
const BLOCK_ROWS: usize = 256;

/// ΦᵀΦ of unit columns.
pub struct GramMatrix {
    /// N × N.
    values: DMatrix<f64>,
}

impl GramMatrix {
    /// Sums two halves of the rows, the same two on every machine, so that rounding is the same.
    pub fn new(columns: &[&[f64]]) -> GramMatrix {
        let n = columns.len();
        let rows = columns.first().map_or(0, |c| c.len());
        let middle = rows / 2;
        let first = || lower_products(columns, 0..middle);
        let second = || lower_products(columns, middle..rows);
        let (mut values, other) = match n * n * rows > RANK.two_threads {
            true => threads::join(first, second),
            false => (first(), second()),
        };
        for j in 0..n {
            for i in j..n {
                values[(i, j)] += other[(i, j)];
                values[(j, i)] = values[(i, j)];
            }
        }
        GramMatrix { values }
    }

    pub fn of(design: &ScaledDesign) -> GramMatrix {
        let columns: Vec<&[f64]> = design.columns.iter().map(|c| &c.unit[..]).collect();
        GramMatrix::new(&columns)
    }

    pub fn len(&self) -> usize {
        self.values.nrows()
    }

    pub fn cosine(&self, i: usize, j: usize) -> f64 {
        self.values[(i, j)]
    }

    /// The cosines of one column with all others.
    pub fn column(&self, j: usize) -> &[f64] {
        let n = self.len();
        &self.values.as_slice()[j * n..(j + 1) * n]
    }

    /// The numerical rank, as far as inner products show it.
    fn rank(&self) -> usize {
        let tolerance = RANK.product_tolerance * RANK.product_tolerance;
        linalg::symmetric_rank(self.values.clone(), tolerance)
    }

    /// The pairs of the largest |cosine|, largest first.
    pub fn largest_cosines(&self, count: usize) -> Vec<(usize, usize, f64)> {
        let mut all: Vec<(usize, usize, f64)> = Vec::new();
        let mut least = 0.0;
        for j in 0..self.len() {
            for (i, cosine) in self.column(j).iter().enumerate().take(j) {
                if cosine.abs() > least {
                    all.push((i, j, *cosine));
                    if all.len() > 8 * count {
                        largest_first(&mut all, count);
                        least = all.last().map_or(0.0, |p| p.2.abs());
                    }
                }
            }
        }
        largest_first(&mut all, count);
        all
    }

    /// The condition number of some columns; at most the inverse of the rank tolerance, beyond which inner products show nothing.
    pub fn condition(&self, columns: &[usize]) -> f64 {
        let tolerance = RANK.product_tolerance;
        match self.extreme_singular_values(columns) {
            Some((least, most)) => (most / least.max(tolerance * most)).min(1.0 / tolerance),
            None => 1.0,
        }
    }

    /// Smallest and largest singular value of some columns.
    pub fn extreme_singular_values(&self, columns: &[usize]) -> Option<(f64, f64)> {
        let k = columns.len();
        if k == 0 {
            return None;
        }
        let part = DMatrix::from_fn(k, k, |i, j| self.cosine(columns[i], columns[j]));
        let values = part.symmetric_eigenvalues();
        Some((values.min().max(0.0).sqrt(), values.max().max(0.0).sqrt()))
    }
}

/// The numerical rank of a design's columns, and the part of the largest singular value below which one counts as zero: from the
/// columns themselves if that is quick, else from their inner products.
pub fn rank(design: &ScaledDesign, gram: &GramMatrix) -> (usize, f64) {
    let (m, n) = (design.rows(), design.columns.len());
    if m * n * n > RANK.factorisation {
        return (gram.rank(), RANK.product_tolerance);
    }
    let mut columns = DMatrix::zeros(m, n);
    for (j, mut column) in columns.column_iter_mut().enumerate() {
        column.copy_from_slice(design.unit(j));
    }
    let tall = if m < n { columns.transpose() } else { columns };
    let tolerance = RANK.column_tolerance;
    (linalg::rank(Qr::new(tall).r, tolerance), tolerance)
}

/// ΦᵀΦ over some rows, lower half.
fn lower_products(columns: &[&[f64]], rows: Range<usize>) -> DMatrix<f64> {
    let n = columns.len();
    let mut values = DMatrix::zeros(n, n);
    let mut part = vec![0.0; BLOCK_ROWS * n];
    for start in rows.clone().step_by(BLOCK_ROWS) {
        let count = BLOCK_ROWS.min(rows.end - start);
        for (out, column) in part.chunks_exact_mut(count).zip(columns) {
            out.copy_from_slice(&column[start..start + count]);
        }
        let part = &part[..count * n];
        let block = DMatrixView::from_slice(part, count, n);
        add_products(&mut values, &transposed(part, count, n), &block);
    }
    values
}

fn largest_first(all: &mut Vec<(usize, usize, f64)>, count: usize) {
    all.sort_by(|a, b| {
        let size = b.2.abs().total_cmp(&a.2.abs());
        size.then((a.0, a.1).cmp(&(b.0, b.1)))
    });
    all.truncate(count);
}
