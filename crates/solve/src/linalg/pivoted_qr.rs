//! A Π = Q R with column pivoting (Golub & Van Loan, section 5.4), unblocked: for few columns.

use super::householder::{norm, reflect, reflector};
use crate::simd::wide;
use crate::thresholds::FACTORISATION;

/// R and the reflections of A Π = Q R.
pub struct PivotedQr {
    rows: usize,
    /// By columns: R on and above the diagonal, the reflections below.
    factors: Vec<f64>,
    taus: Vec<f64>,
    /// `order[i]` is the column of A at place i.
    pub order: Vec<usize>,
}

impl PivotedQr {
    /// Of columns of `rows` numbers; `rows` is not zero.
    pub fn new(rows: usize, factors: Vec<f64>) -> PivotedQr {
        let order = (0..factors.len() / rows).collect();
        let mut qr = PivotedQr {
            rows,
            factors,
            taus: Vec::new(),
            order,
        };
        wide(|| qr.factorise());
        qr
    }

    #[inline(always)]
    fn factorise(&mut self) {
        let (m, n) = (self.rows, self.order.len());
        let columns = self.factors.chunks_exact(m);
        let mut left: Vec<f64> = columns.map(norm).collect();
        let mut known = left.clone();
        for j in 0..m.min(n) {
            let largest = (j..n).fold(j, |best, k| if left[k] > left[best] { k } else { best });
            if largest != j {
                let (a, b) = self.factors.split_at_mut(largest * m);
                a[j * m..(j + 1) * m].swap_with_slice(&mut b[..m]);
                self.order.swap(j, largest);
                left.swap(j, largest);
                known.swap(j, largest);
            }
            let (done, rest) = self.factors.split_at_mut((j + 1) * m);
            let v = &mut done[j * m + j..];
            let tau = reflector(v);
            self.taus.push(tau);
            for (k, column) in (j + 1..n).zip(rest.chunks_exact_mut(m)) {
                reflect(v, tau, &mut column[j..]);
                let part = if left[k] > 0.0 {
                    column[j] / left[k]
                } else {
                    0.0
                };
                let square = (1.0 - part * part).max(0.0);
                if square * (left[k] / known[k]).powi(2) > FACTORISATION.norm_update {
                    left[k] *= square.sqrt();
                } else {
                    left[k] = norm(&column[j + 1..]);
                    known[k] = left[k];
                }
            }
        }
    }

    /// R at (i, j), i ≤ j.
    pub fn r(&self, i: usize, j: usize) -> f64 {
        self.factors[j * self.rows + i]
    }

    /// Qᵀ y
    pub fn q_tr_mul(&self, mut y: Vec<f64>) -> Vec<f64> {
        wide(|| {
            for (j, tau) in self.taus.iter().enumerate() {
                reflect(self.reflector(j), *tau, &mut y[j..]);
            }
        });
        y
    }

    /// Q (z; 0)
    pub fn q_mul(&self, mut z: Vec<f64>) -> Vec<f64> {
        z.resize(self.rows, 0.0);
        wide(|| {
            for (j, tau) in self.taus.iter().enumerate().rev() {
                reflect(self.reflector(j), *tau, &mut z[j..]);
            }
        });
        z
    }

    fn reflector(&self, j: usize) -> &[f64] {
        &self.factors[j * self.rows + j..(j + 1) * self.rows]
    }
}
