//! The cosines between all columns: rank, coherence, condition.
//!
//! In: unit columns. Out: figures. Products of columns carry half the digits of the columns: relations found here are measured
//! again on the columns themselves.

use std::ops::Range;

use nalgebra::{DMatrix, DMatrixView};

use crate::scaled_design::ScaledDesign;
use sidc_solve::linalg::{self, Qr, add_products, transposed};
use sidc_solve::threads;

/// Singular values under this part of the largest are zero: what products leave of sixteen digits.
pub(super) const TOLERANCE: f64 = 1e-7;
/// The same for the columns themselves.
const FINE: f64 = 1e-10;
/// Multiplications that a factorisation of the columns may take.
const DIRECT: usize = 300_000_000;
/// Multiplications below which a second thread costs more than it saves.
const ALONE: usize = 20_000_000;
/// Rows multiplied at once: they stay in a core's cache.
const AT_ONCE: usize = 256;

/// ΦᵀΦ of unit columns.
pub(super) struct Gram {
    /// N × N.
    values: DMatrix<f64>,
}

impl Gram {
    /// In two halves of the rows, side by side: the same two on every machine, so that sums come out the same.
    pub fn new(columns: &[&[f64]]) -> Gram {
        let n = columns.len();
        let rows = columns.first().map_or(0, |c| c.len());
        let middle = rows / 2;
        let early = || products(columns, 0..middle);
        let late = || products(columns, middle..rows);
        let (mut values, other) = match n * n * rows > ALONE {
            true => threads::join(early, late),
            false => (early(), late()),
        };
        for j in 0..n {
            for i in j..n {
                values[(i, j)] += other[(i, j)];
                values[(j, i)] = values[(i, j)];
            }
        }
        Gram { values }
    }

    pub fn of(frame: &ScaledDesign) -> Gram {
        let columns: Vec<&[f64]> = frame.columns.iter().map(|c| &c.unit[..]).collect();
        Gram::new(&columns)
    }

    pub fn len(&self) -> usize {
        self.values.nrows()
    }

    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.values[(i, j)]
    }

    /// The cosines of one column with all others.
    pub fn column(&self, j: usize) -> &[f64] {
        let n = self.len();
        &self.values.as_slice()[j * n..(j + 1) * n]
    }

    /// Singular values above [`TOLERANCE`] of the largest.
    pub fn rank(&self) -> usize {
        linalg::symmetric_rank(self.values.clone(), TOLERANCE * TOLERANCE)
    }

    /// The pairs of the largest |cosine|, worst first.
    pub fn worst(&self, most: usize) -> Vec<(usize, usize, f64)> {
        let mut all: Vec<(usize, usize, f64)> = Vec::new();
        let mut bar = 0.0;
        for j in 0..self.len() {
            for (i, cosine) in self.column(j).iter().enumerate().take(j) {
                if cosine.abs() > bar {
                    all.push((i, j, *cosine));
                    if all.len() > 8 * most {
                        worst_first(&mut all, most);
                        bar = all.last().map_or(0.0, |p| p.2.abs());
                    }
                }
            }
        }
        worst_first(&mut all, most);
        all
    }

    /// Largest over smallest singular value of some columns; at most 1/[`TOLERANCE`], beyond which products do not see.
    pub fn condition(&self, places: &[usize]) -> f64 {
        match self.extremes(places) {
            Some((least, most)) => (most / least.max(TOLERANCE * most)).min(1.0 / TOLERANCE),
            None => 1.0,
        }
    }

    /// Smallest and largest singular value of some columns.
    pub fn extremes(&self, places: &[usize]) -> Option<(f64, f64)> {
        let k = places.len();
        if k == 0 {
            return None;
        }
        let part = DMatrix::from_fn(k, k, |i, j| self.at(places[i], places[j]));
        let values = part.symmetric_eigenvalues();
        Some((values.min().max(0.0).sqrt(), values.max().max(0.0).sqrt()))
    }
}

/// Numerical rank of a frame's columns, and the part of the largest singular value under which one is zero: by the columns
/// themselves where that is quick, else by their products.
pub(super) fn rank(frame: &ScaledDesign, gram: &Gram) -> (usize, f64) {
    let (m, n) = (frame.rows(), frame.columns.len());
    if m * n * n > DIRECT {
        return (gram.rank(), TOLERANCE);
    }
    let mut columns = DMatrix::zeros(m, n);
    for (j, mut column) in columns.column_iter_mut().enumerate() {
        column.copy_from_slice(frame.unit(j));
    }
    let tall = if m < n { columns.transpose() } else { columns };
    (linalg::rank(Qr::new(tall).r, FINE), FINE)
}

/// ΦᵀΦ over some rows, lower half.
fn products(columns: &[&[f64]], rows: Range<usize>) -> DMatrix<f64> {
    let n = columns.len();
    let mut values = DMatrix::zeros(n, n);
    let mut part = vec![0.0; AT_ONCE * n];
    for start in rows.clone().step_by(AT_ONCE) {
        let count = AT_ONCE.min(rows.end - start);
        for (out, column) in part.chunks_exact_mut(count).zip(columns) {
            out.copy_from_slice(&column[start..start + count]);
        }
        let part = &part[..count * n];
        let block = DMatrixView::from_slice(part, count, n);
        add_products(&mut values, &transposed(part, count, n), &block);
    }
    values
}

fn worst_first(all: &mut Vec<(usize, usize, f64)>, most: usize) {
    all.sort_by(|a, b| {
        let size = b.2.abs().total_cmp(&a.2.abs());
        size.then((a.0, a.1).cmp(&(b.0, b.1)))
    });
    all.truncate(most);
}
