//! A = Q R by blocked Householder reflections: the reflections of a panel of columns are applied to the columns on the right as one
//! matrix product (compact WY form, Schreiber & Van Loan 1989).

use nalgebra::DMatrix;

use super::householder::{reflect, reflector};
use super::products::{gemm, transposed};
use crate::simd::wide;

/// Columns of a panel: a size of tiles, which decides nothing but speed.
const PANEL_COLUMNS: usize = 24;

/// Q as reflections, and R.
pub struct Qr {
    rows: usize,
    panels: Vec<Panel>,
    /// R, min(M, N) × N, with zeros under its diagonal.
    pub r: DMatrix<f64>,
}

/// I − V T Vᵀ: the product of the reflections of some columns.
struct Panel {
    first: usize,
    /// Unit lower trapezoid.
    v: DMatrix<f64>,
    /// Upper triangle.
    t: DMatrix<f64>,
}

impl Qr {
    pub fn new(mut a: DMatrix<f64>) -> Qr {
        let (m, n) = a.shape();
        let k = m.min(n);
        let mut panels = Vec::new();
        for first in (0..k).step_by(PANEL_COLUMNS) {
            let width = PANEL_COLUMNS.min(k - first);
            let taus = wide(|| factorise(&mut a, first, width));
            let panel = Panel::new(&a, first, &taus);
            panel.reflect(&mut a, first + width, true);
            panels.push(panel);
        }
        let mut r = a.resize_vertically(k, 0.0);
        r.fill_lower_triangle(0.0, 1);
        Qr { rows: m, panels, r }
    }

    /// Q (x; 0), of M rows.
    pub fn q_mul(&self, x: DMatrix<f64>) -> DMatrix<f64> {
        let mut out = x.resize_vertically(self.rows, 0.0);
        for panel in self.panels.iter().rev() {
            panel.reflect(&mut out, 0, false);
        }
        out
    }
}

/// Factorises the columns of one panel. Returns the τ of each reflection.
#[inline(always)]
fn factorise(a: &mut DMatrix<f64>, first: usize, width: usize) -> Vec<f64> {
    let m = a.nrows();
    let columns = &mut a.as_mut_slice()[first * m..(first + width) * m];
    let mut taus = Vec::with_capacity(width);
    for j in 0..width {
        let (done, rest) = columns.split_at_mut((j + 1) * m);
        let v = &mut done[j * m + first + j..];
        let tau = reflector(v);
        for column in rest.chunks_exact_mut(m) {
            reflect(v, tau, &mut column[first + j..]);
        }
        taus.push(tau);
    }
    taus
}

impl Panel {
    fn new(a: &DMatrix<f64>, first: usize, taus: &[f64]) -> Panel {
        let w = taus.len();
        let mut v = a.view((first, first), (a.nrows() - first, w)).into_owned();
        v.fill_upper_triangle(0.0, 1);
        v.fill_diagonal(1.0);
        let mut products = DMatrix::zeros(w, w);
        let across = transposed(v.as_slice(), v.nrows(), w);
        gemm(1.0, &across, &v, 0.0, products.as_view_mut());
        let mut t = DMatrix::zeros(w, w);
        for (j, tau) in taus.iter().enumerate() {
            for i in 0..j {
                let sum: f64 = (i..j).map(|k| t[(i, k)] * products[(k, j)]).sum();
                t[(i, j)] = -tau * sum;
            }
            t[(j, j)] = *tau;
        }
        Panel { first, v, t }
    }

    /// Applies the panel to the columns from `from` on, transposed if `back`.
    fn reflect(&self, a: &mut DMatrix<f64>, from: usize, back: bool) {
        let n = a.ncols() - from;
        if n == 0 {
            return;
        }
        let (m, w) = self.v.shape();
        let mut part = a.view_mut((self.first, from), (m, n));
        let mut along = DMatrix::zeros(w, n);
        let across = transposed(self.v.as_slice(), m, w);
        gemm(1.0, &across, &part, 0.0, along.as_view_mut());
        let along = match back {
            true => self.t.tr_mul(&along),
            false => &self.t * along,
        };
        gemm(-1.0, &self.v, &along, 1.0, part.as_view_mut());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::PivotedQr;
    use crate::linalg::products::tests::matrix;

    #[test]
    fn factors_multiply_back() {
        for (m, n) in [(1, 1), (5, 2), (2, 5), (100, 60), (60, 100)] {
            let a = matrix(m, n);
            let qr = Qr::new(a.clone());
            assert!((qr.q_mul(qr.r.clone()) - &a).amax() < 1e-13, "{m} {n}");
            let pivoted = PivotedQr::new(m, a.as_slice().to_vec());
            let sizes: Vec<f64> = (0..m.min(n)).map(|i| pivoted.r(i, i).abs()).collect();
            assert!(sizes.is_sorted_by(|a, b| a >= b), "{sizes:?}");
            for (j, column) in pivoted.order.iter().enumerate() {
                let r = (0..=j.min(m - 1)).map(|i| pivoted.r(i, j)).collect();
                let back = DMatrix::from_vec(m, 1, pivoted.q_mul(r));
                assert!((back - a.columns(*column, 1)).amax() < 1e-13);
                let r = pivoted.q_tr_mul(a.column(*column).as_slice().to_vec());
                assert!((r[0] - pivoted.r(0, j)).abs() < 1e-13);
            }
        }
    }
}
