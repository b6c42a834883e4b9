//! The triangle of a least-squares problem that grows by rows: R with RᵀR = AᵀA, without ever forming AᵀA.
//!
//! In: rows [a | right]. Out: the triangle, the least residual, coefficients of any choice of columns. Rows wait in a buffer and
//! are reduced many at once.

use faer::Mat;
use faer::linalg::solvers::Qr;

/// R of [A | b], (P + 1) × (P + 1), upper triangular; the last diagonal entry is the norm of what no combination explains.
#[derive(Clone, Debug)]
pub(super) struct Triangle {
    width: usize,
    /// By rows; the triangle so far, then waiting rows.
    rows: Vec<f64>,
    /// How many of the rows are the triangle.
    reduced: usize,
}

/// Waiting rows per row of the triangle: more makes fewer, larger reductions.
const WAITING: usize = 4;
/// Pivot under which a column depends on those before it, relative to its norm.
const DEPENDENT: f64 = 1e-10;

impl Triangle {
    /// For P columns.
    pub fn new(columns: usize) -> Self {
        Triangle {
            width: columns + 1,
            rows: Vec::new(),
            reduced: 0,
        }
    }

    /// One more row [a | right].
    pub fn add(&mut self, row: &[f64]) {
        self.rows.extend_from_slice(row);
        let waiting = self.rows.len() / self.width - self.reduced;
        if waiting >= (WAITING * self.width).max(64) {
            self.reduce();
        }
    }

    /// Takes in what waits.
    pub fn reduce(&mut self) {
        let (w, count) = (self.width, self.rows.len() / self.width);
        if count == self.reduced {
            return;
        }
        let all = Mat::from_fn(count, w, |i, j| self.rows[i * w + j]);
        let qr = Qr::new(all.as_ref());
        let r = qr.thin_R();
        let kept = r.nrows().min(w);
        self.rows.clear();
        for i in 0..kept {
            self.rows
                .extend((0..w).map(|j| if j < i { 0.0 } else { r[(i, j)] }));
        }
        self.reduced = kept;
    }

    /// The right side for unknowns that count from `−x`, not from zero: b + A x. `x` pairs columns with values.
    pub fn shift(&mut self, x: &[(usize, f64)]) {
        let w = self.width;
        for row in self.rows.chunks_exact_mut(w) {
            let moved: f64 = x.iter().map(|(j, x)| row[*j] * x).sum();
            row[w - 1] += moved;
        }
    }

    /// Number of columns without the right side.
    pub fn columns(&self) -> usize {
        self.width - 1
    }

    /// AᵀA and Aᵀb with bᵀb as its last row and column, by rows; after [`Triangle::reduce`].
    pub fn gram(&self) -> Vec<f64> {
        let w = self.width;
        let rows = self.rows.len() / w;
        let r = Mat::from_fn(rows, w, |i, j| self.rows[i * w + j]);
        let g = r.transpose() * &r;
        (0..w * w).map(|k| g[(k / w, k % w)]).collect()
    }

    /// Least squares on all columns: coefficients, the residual's square, and the inverse triangle's rows' squares
    /// (variances at unit error). Columns that depend on those before them get zero.
    pub fn solve(&mut self) -> Solved {
        self.reduce();
        let (w, p) = (self.width, self.width - 1);
        let count = self.rows.len() / w;
        let at = |i: usize, j: usize| if i < count { self.rows[i * w + j] } else { 0.0 };
        let norm = |j: usize| (0..=j).map(|i| at(i, j).powi(2)).sum::<f64>().sqrt();
        let free: Vec<bool> = (0..p)
            .map(|j| at(j, j).abs() > DEPENDENT * norm(j) && at(j, j) != 0.0)
            .collect();
        let back = |right: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let mut x = vec![0.0; p];
            for i in (0..p).rev().filter(|i| free[*i]) {
                let sum: f64 = (i + 1..p).map(|j| at(i, j) * x[j]).sum();
                x[i] = (right(i) - sum) / at(i, i);
            }
            x
        };
        let coefficients = back(&|i| at(i, p));
        let mut residual = at(p, p).powi(2);
        for i in (0..p).filter(|i| !free[*i]) {
            let sum: f64 = (i + 1..p).map(|j| at(i, j) * coefficients[j]).sum();
            residual += (at(i, p) - sum).powi(2);
        }
        let mut variances = vec![0.0; p];
        for k in 0..p {
            let column = back(&|i| if i == k { 1.0 } else { 0.0 });
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
}

/// Coefficients of a triangle.
pub(super) struct Solved {
    pub coefficients: Vec<f64>,
    /// Square of the residual.
    pub residual: f64,
    /// Of the coefficients, at unit error of the rows.
    pub variances: Vec<f64>,
}
