//! The QR factorisation of a least-squares problem that grows by rows: R with RᵀR = AᵀA, without forming AᵀA.
//!
//! In: rows [a | right]. Out: coefficients, residual, covariances. Rows wait in a buffer and are reduced many at once by Householder
//! reflections (Golub & Van Loan, section 5.2).

use super::square_root_information_filter::RowSink;
use crate::trajectory::thresholds::GAUSS_NEWTON;
use sidc_solve::simd::{axpy, wide};

/// R of [A | b], (P + 1) × (P + 1), upper triangular; its last diagonal entry is the norm of the residual.
#[derive(Clone, Debug)]
pub(crate) struct IncrementalQr {
    width: usize,
    /// R by rows.
    triangle: Vec<f64>,
    /// Rows not yet reduced.
    rows: Vec<f64>,
    /// The same, column-major.
    columns: Vec<f64>,
}

/// Rows reduced at once: many, so that passing over R costs little; few enough to stay in the cache.
const BUFFERED_ROWS: usize = 128;

impl RowSink for IncrementalQr {
    fn columns(&self) -> usize {
        self.width - 1
    }

    fn reserve_rows(&mut self, rows: usize) -> &mut [f64] {
        if self.rows.len() + rows * self.width > BUFFERED_ROWS * self.width {
            self.reduce();
        }
        let start = self.rows.len();
        self.rows.resize(start + rows * self.width, 0.0);
        &mut self.rows[start..]
    }
}

impl IncrementalQr {
    /// For P columns.
    pub fn new(columns: usize) -> Self {
        let width = columns + 1;
        IncrementalQr {
            width,
            triangle: vec![0.0; width * width],
            rows: Vec::new(),
            columns: Vec::new(),
        }
    }

    /// Reduces the buffered rows: reflection j changes row j of R and all of them.
    fn reduce(&mut self) {
        wide(|| self.wide_reduce());
    }

    #[inline(always)]
    fn wide_reduce(&mut self) {
        let (w, count) = (self.width, self.rows.len() / self.width);
        if count == 0 {
            return;
        }
        self.columns.resize(w * count, 0.0);
        for (k, row) in self.rows.chunks_exact(w).enumerate() {
            for (j, x) in row.iter().enumerate() {
                self.columns[j * count + k] = *x;
            }
        }
        self.rows.clear();
        for j in 0..w {
            let (done, rest) = self.columns[..w * count].split_at_mut((j + 1) * count);
            let v = &done[j * count..];
            let below = dot(v, v);
            if below == 0.0 {
                continue;
            }
            let head = self.triangle[j * w + j];
            let norm = (head * head + below).sqrt();
            let norm = if head > 0.0 { -norm } else { norm };
            let first = head - norm;
            let scale = 1.0 / (norm * first);
            self.triangle[j * w + j] = norm;
            let heads = &mut self.triangle[j * w + j + 1..(j + 1) * w];
            for (head, column) in heads.iter_mut().zip(rest.chunks_exact_mut(count)) {
                let along = scale * (first * *head + dot(v, column));
                *head += first * along;
                axpy(along, v, column);
            }
        }
    }

    /// Least squares on all columns. Those that depend on columns before them get the coefficient 0 and an infinite variance.
    pub fn solve(&mut self) -> Solution {
        self.reduce();
        let p = self.width - 1;
        let independent = self.independent();
        let coefficients = self.back_substitute(&independent, &|i| self.at(i, p));
        let mut residual = self.at(p, p).powi(2);
        for i in (0..p).filter(|i| !independent[*i]) {
            let sum: f64 = (i + 1..p).map(|j| self.at(i, j) * coefficients[j]).sum();
            residual += (self.at(i, p) - sum).powi(2);
        }
        let mut variances = vec![0.0; p];
        for column in self.inverse(&independent) {
            for (v, x) in variances.iter_mut().zip(column) {
                *v += x * x;
            }
        }
        for (v, independent) in variances.iter_mut().zip(&independent) {
            if !independent {
                *v = f64::INFINITY;
            }
        }
        Solution {
            coefficients,
            residual,
            variances,
        }
    }

    /// Squared norm of the residual with all coefficients zero. After [`IncrementalQr::solve`].
    pub fn square_without_step(&self) -> f64 {
        let p = self.width - 1;
        (0..=p).map(|i| self.at(i, p).powi(2)).sum()
    }

    /// Columns of (RᵀR)⁻¹; `None` for dependent columns.
    pub fn covariances(&mut self) -> Vec<Option<Vec<f64>>> {
        self.reduce();
        let independent = self.independent();
        let inverse = self.inverse(&independent);
        let column = |j: usize| {
            let mut sum = vec![0.0; independent.len()];
            for part in &inverse {
                for (s, x) in sum.iter_mut().zip(part) {
                    *s += part[j] * x;
                }
            }
            independent[j].then_some(sum)
        };
        (0..independent.len()).map(column).collect()
    }

    /// R of [A | b] over all rows.
    pub fn factor(&mut self) -> TriangularFactor<'_> {
        self.reduce();
        TriangularFactor(self)
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.triangle[i * self.width + j]
    }

    /// Which columns do not depend on those before them.
    fn independent(&self) -> Vec<bool> {
        let norm = |j: usize| (0..=j).map(|i| self.at(i, j).powi(2)).sum::<f64>().sqrt();
        let independent = |j: usize| {
            self.at(j, j).abs() > GAUSS_NEWTON.dependent_pivot * norm(j) && self.at(j, j) != 0.0
        };
        (0..self.width - 1).map(independent).collect()
    }

    /// Solves R x = right, with zeros for dependent columns.
    fn back_substitute(&self, independent: &[bool], right: &dyn Fn(usize) -> f64) -> Vec<f64> {
        let p = independent.len();
        let mut x = vec![0.0; p];
        for i in (0..p).rev().filter(|i| independent[*i]) {
            let sum: f64 = (i + 1..p).map(|j| self.at(i, j) * x[j]).sum();
            x[i] = (right(i) - sum) / self.at(i, i);
        }
        x
    }

    /// R⁻¹ by columns.
    fn inverse(&self, independent: &[bool]) -> Vec<Vec<f64>> {
        let unit =
            |k: usize| self.back_substitute(independent, &|i| if i == k { 1.0 } else { 0.0 });
        (0..independent.len()).map(unit).collect()
    }
}

/// R of [A | b], the right side last.
#[derive(Clone, Copy)]
pub(crate) struct TriangularFactor<'a>(&'a IncrementalQr);

impl TriangularFactor<'_> {
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        self.0.at(i, j)
    }
}

/// A least-squares solution.
pub(crate) struct Solution {
    pub coefficients: Vec<f64>,
    /// Squared norm of the residual.
    pub residual: f64,
    /// Of the coefficients, for rows with unit errors.
    pub variances: Vec<f64>,
}

/// In eight partial sums, so that it vectorises; their order is fixed.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest: f64 = rest.map(|(x, y)| x * y).sum();
    let mut sums = [0.0; 8];
    for (a, b) in a.zip(b) {
        for (sum, (x, y)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += x * y;
        }
    }
    rest + sums.iter().sum::<f64>()
}
