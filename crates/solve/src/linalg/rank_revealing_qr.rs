//! Least squares by QR with column pivoting, cut at the numerical rank (Golub & Van Loan, section 5.5).

use nalgebra::DMatrix;

use super::pivoted_qr::PivotedQr;
use crate::thresholds::NUMERICAL_RANK;

/// P Π = Q R, cut at the numerical rank.
pub struct RankRevealingQr {
    qr: PivotedQr,
    pub rank: usize,
}

impl RankRevealingQr {
    /// `None` for an empty matrix or one that is not finite.
    pub fn new(unit: &DMatrix<f64>) -> Option<RankRevealingQr> {
        if unit.nrows() == 0 || unit.ncols() == 0 {
            return None;
        }
        let qr = PivotedQr::new(unit.nrows(), unit.as_slice().to_vec());
        let first = qr.r(0, 0).abs();
        if !(first > 0.0 && first.is_finite()) {
            return None;
        }
        let size = unit.nrows().min(unit.ncols());
        let rank = (0..size)
            .take_while(|&i| qr.r(i, i).abs() > NUMERICAL_RANK.dependent * first)
            .count();
        Some(RankRevealingQr { qr, rank })
    }

    /// Least-squares solution with zeros at dependent columns.
    pub fn solve(&self, y: &[f64]) -> Vec<f64> {
        let mut z = self.qr.q_tr_mul(y.to_vec());
        z.truncate(self.rank);
        for i in (0..self.rank).rev() {
            let known: f64 = (i + 1..self.rank).map(|j| self.qr.r(i, j) * z[j]).sum();
            z[i] = (z[i] - known) / self.qr.r(i, i);
        }
        let mut x = vec![0.0; self.qr.order.len()];
        for (z, &at) in z.iter().zip(&self.qr.order) {
            x[at] = *z;
        }
        x
    }

    /// Columns of P, the independent ones first.
    pub fn columns(&self) -> &[usize] {
        &self.qr.order
    }

    /// As many columns as the rank, independent of each other.
    pub fn independent(&self) -> &[usize] {
        &self.qr.order[..self.rank]
    }

    /// The δ of least norm with Pᵀ δ = c on the independent columns.
    pub fn least_norm(&self, c: &[f64]) -> Vec<f64> {
        let mut z: Vec<f64> = self.independent().iter().map(|&at| c[at]).collect();
        for i in 0..z.len() {
            let known: f64 = (0..i).map(|j| self.qr.r(j, i) * z[j]).sum();
            z[i] = (z[i] - known) / self.qr.r(i, i);
        }
        self.qr.q_mul(z)
    }
}
