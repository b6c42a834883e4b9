//! The triangle of a least-squares problem that grows by rows: R with RᵀR = AᵀA, without ever forming AᵀA.
//!
//! In: rows [a | right]. Out: coefficients, the least residual, variances. Rows wait in a buffer and are reduced many at once, by
//! Householder reflections of columns.

use super::sweep::Gather;
use crate::lanes::{axpy, wide};

/// R of [A | b], (P + 1) × (P + 1), upper triangular; the last diagonal entry is the norm of what no combination explains.
#[derive(Clone, Debug)]
pub(super) struct Triangle {
    width: usize,
    /// R by rows, zero to begin with.
    triangle: Vec<f64>,
    /// Waiting rows.
    rows: Vec<f64>,
    /// Waiting rows by columns.
    columns: Vec<f64>,
}

/// Rows taken in at once: enough to hide the triangle's own, few enough to stay in the cache.
const WAITING: usize = 128;
/// Pivot under which a column depends on those before it, relative to its norm.
const DEPENDENT: f64 = 1e-10;

impl Gather for Triangle {
    fn columns(&self) -> usize {
        self.width - 1
    }

    fn room(&mut self, rows: usize) -> &mut [f64] {
        if self.rows.len() + rows * self.width > WAITING * self.width {
            self.reduce();
        }
        let start = self.rows.len();
        self.rows.resize(start + rows * self.width, 0.0);
        &mut self.rows[start..]
    }
}

impl Triangle {
    /// For P columns.
    pub fn new(columns: usize) -> Self {
        let width = columns + 1;
        Triangle {
            width,
            triangle: vec![0.0; width * width],
            rows: Vec::new(),
            columns: Vec::new(),
        }
    }

    /// Takes in what waits. Column j touches row j of the triangle and all
    /// waiting rows.
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

    /// Least squares on all columns: coefficients, the residual's square, and the inverse triangle's rows' squares
    /// (variances at unit error). Columns that depend on those before them get zero.
    pub fn solve(&mut self) -> Solved {
        self.reduce();
        let p = self.width - 1;
        let free = self.free();
        let coefficients = self.back(&free, &|i| self.at(i, p));
        let mut residual = self.at(p, p).powi(2);
        for i in (0..p).filter(|i| !free[*i]) {
            let sum: f64 = (i + 1..p).map(|j| self.at(i, j) * coefficients[j]).sum();
            residual += (self.at(i, p) - sum).powi(2);
        }
        let mut variances = vec![0.0; p];
        for column in self.inverse(&free) {
            for (v, x) in variances.iter_mut().zip(column) {
                *v += x * x;
            }
        }
        for (v, free) in variances.iter_mut().zip(&free) {
            if !free {
                *v = f64::INFINITY;
            }
        }
        Solved {
            coefficients,
            residual,
            variances,
        }
    }

    /// Columns of (RᵀR)⁻¹: what a unit on the right of each normal equation moves. `None` for dependent columns.
    pub fn covariances(&mut self) -> Vec<Option<Vec<f64>>> {
        self.reduce();
        let free = self.free();
        let inverse = self.inverse(&free);
        let column = |j: usize| {
            let mut sum = vec![0.0; free.len()];
            for part in &inverse {
                for (s, x) in sum.iter_mut().zip(part) {
                    *s += part[j] * x;
                }
            }
            free[j].then_some(sum)
        };
        (0..free.len()).map(column).collect()
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.triangle[i * self.width + j]
    }

    /// Columns that do not depend on those before them.
    fn free(&self) -> Vec<bool> {
        let norm = |j: usize| (0..=j).map(|i| self.at(i, j).powi(2)).sum::<f64>().sqrt();
        let free = |j: usize| self.at(j, j).abs() > DEPENDENT * norm(j) && self.at(j, j) != 0.0;
        (0..self.width - 1).map(free).collect()
    }

    /// R x = right, zeros where columns are not free.
    fn back(&self, free: &[bool], right: &dyn Fn(usize) -> f64) -> Vec<f64> {
        let p = free.len();
        let mut x = vec![0.0; p];
        for i in (0..p).rev().filter(|i| free[*i]) {
            let sum: f64 = (i + 1..p).map(|j| self.at(i, j) * x[j]).sum();
            x[i] = (right(i) - sum) / self.at(i, i);
        }
        x
    }

    /// R⁻¹ by columns.
    fn inverse(&self, free: &[bool]) -> Vec<Vec<f64>> {
        let unit = |k: usize| self.back(free, &|i| if i == k { 1.0 } else { 0.0 });
        (0..free.len()).map(unit).collect()
    }
}

/// Coefficients of a triangle.
pub(super) struct Solved {
    pub coefficients: Vec<f64>,
    /// Square of the residual.
    pub residual: f64,
    /// Of the coefficients, at unit error of the rows.
    pub variances: Vec<f64>,
}

/// In eight sums side by side, always the same ones.
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
