//! P = Q R of the active columns, updated as columns enter and leave.
//!
//! In: columns of M numbers. Out: projections and triangular solves. A column enters by Gram–Schmidt twice (orthogonal to
//! rounding: Giraud, Langou & Rozložník 2005) and leaves by plane rotations (Golub & Van Loan, section 6.5.2). O(M k) each.

use crate::linalg::{difference, gemv, gemv_tr, norm};
use crate::simd::axpy;
use crate::thresholds::NUMERICAL_RANK;

/// Q (M × k) and R (k × k) of k active columns.
pub(super) struct UpdatedQr {
    rows: usize,
    /// Column-major, M · k.
    basis: Vec<f64>,
    /// Column i of R, i + 1 entries.
    triangle: Vec<Vec<f64>>,
}

/// y = P a + d with d orthogonal to P.
pub(super) struct Fit {
    /// a, length k.
    pub coefficients: Vec<f64>,
    /// d, length M.
    pub residual: Vec<f64>,
}

impl UpdatedQr {
    pub fn new(rows: usize) -> UpdatedQr {
        UpdatedQr {
            rows,
            basis: Vec::new(),
            triangle: Vec::new(),
        }
    }

    pub fn len(&self) -> usize {
        self.triangle.len()
    }

    /// Appends a column; false, and no change, if it depends on the others.
    pub fn push(&mut self, column: &[f64]) -> bool {
        let (mut inside, mut rest) = self.split(column);
        let length = norm(&rest);
        let dependent = NUMERICAL_RANK.dependent * norm(column);
        if length.is_nan() || length <= dependent || self.len() >= self.rows {
            return false;
        }
        rest.iter_mut().for_each(|x| *x /= length);
        self.basis.extend_from_slice(&rest);
        inside.push(length);
        self.triangle.push(inside);
        true
    }

    /// Removes column `at`, which must exist.
    pub fn remove(&mut self, at: usize) {
        self.triangle.remove(at);
        for i in at..self.triangle.len() {
            // Column i has one entry below the diagonal: rotate it away.
            let (a, b) = (self.triangle[i][i], self.triangle[i][i + 1]);
            let length = a.hypot(b);
            let (c, s) = (a / length, b / length);
            for column in &mut self.triangle[i..] {
                let (x, y) = (column[i], column[i + 1]);
                (column[i], column[i + 1]) = (c * x + s * y, c * y - s * x);
            }
            self.triangle[i].truncate(i + 1);
            let (left, right) = self.basis.split_at_mut((i + 1) * self.rows);
            let pair = left[i * self.rows..].iter_mut().zip(right);
            pair.for_each(|(x, y)| (*x, *y) = (c * *x + s * *y, c * *y - s * *x));
        }
        self.basis.truncate(self.triangle.len() * self.rows);
    }

    /// The least-squares fit of y.
    pub fn fit(&self, y: &[f64]) -> Fit {
        let (inside, rest) = self.split(y);
        Fit {
            coefficients: self.solve(inside),
            residual: rest,
        }
    }

    /// R⁻¹ b
    pub fn solve(&self, mut b: Vec<f64>) -> Vec<f64> {
        for i in (0..b.len()).rev() {
            b[i] /= self.triangle[i][i];
            let (above, x) = b.split_at_mut(i);
            axpy(-x[0], &self.triangle[i][..i], above);
        }
        b
    }

    /// R⁻ᵀ s
    pub fn solve_transposed(&self, s: &[f64]) -> Vec<f64> {
        let mut z: Vec<f64> = Vec::with_capacity(s.len());
        for (column, s) in self.triangle.iter().zip(s) {
            let known: f64 = column.iter().zip(&z).map(|(r, z)| r * z).sum();
            z.push((s - known) / column[z.len()]);
        }
        z
    }

    /// Q z
    pub fn combine(&self, z: &[f64]) -> Vec<f64> {
        gemv(&self.basis, self.rows, z)
    }

    /// Qᵀv and v − QQᵀv, with one step of refinement.
    fn split(&self, v: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut inside = gemv_tr(&self.basis, self.rows, v);
        let mut rest = difference(v, &self.combine(&inside));
        let again = gemv_tr(&self.basis, self.rows, &rest);
        rest = difference(&rest, &self.combine(&again));
        axpy(1.0, &again, &mut inside);
        (inside, rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_enter_and_leave() {
        let column = |j: usize| -> Vec<f64> {
            let raw: Vec<f64> = (0..7)
                .map(|i| ((i * i + 3 * j + i * j) as f64).sin())
                .collect();
            raw.iter().map(|x| x / norm(&raw)).collect()
        };
        let y: Vec<f64> = (0..7).map(|i| (i as f64).cos()).collect();
        let mut changed = UpdatedQr::new(7);
        (0..5).for_each(|j| assert!(changed.push(&column(j))));
        assert!(!changed.push(&column(2)));
        changed.remove(1);
        changed.remove(2);
        let mut fresh = UpdatedQr::new(7);
        [0, 2, 4]
            .iter()
            .for_each(|j| assert!(fresh.push(&column(*j))));
        let (a, b) = (changed.fit(&y), fresh.fit(&y));
        for (a, b) in a.coefficients.iter().zip(&b.coefficients) {
            assert!((a - b).abs() < 1e-13);
        }
        assert!((norm(&a.residual) - norm(&b.residual)).abs() < 1e-14);
        // Qᵀw = R⁻ᵀs means Pᵀw = s.
        let w = changed.combine(&changed.solve_transposed(&[1.0, -1.0, 1.0]));
        for (j, s) in [(0, 1.0), (2, -1.0), (4, 1.0)] {
            let product: f64 = column(j).iter().zip(&w).map(|(c, w)| c * w).sum();
            assert!((product - s).abs() < 1e-13);
        }
    }
}
