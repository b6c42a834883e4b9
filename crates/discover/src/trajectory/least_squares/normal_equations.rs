//! The normal equations of a least-squares problem that grows by rows: AᵀA, many rows at once.
//!
//! In: rows [a | right]. Out: AᵀA, Aᵀb, bᵀb. Half the work of [`super::IncrementalQr`] and half its digits: enough to propose supports,
//! which are then fitted by QR.

use nalgebra::{DMatrix, DMatrixView};

use super::square_root_information_filter::RowSink;
use sidc_solve::linalg::{add_products, transposed};

/// Rows that are gathered before they are multiplied.
const BUFFERED_ROWS: usize = 256;

/// AᵀA of [A | b], (P + 1) × (P + 1).
#[derive(Clone, Debug)]
pub(crate) struct NormalEquations {
    width: usize,
    /// Buffered rows.
    rows: Vec<f64>,
    /// Lower half.
    products: DMatrix<f64>,
}

impl RowSink for NormalEquations {
    fn columns(&self) -> usize {
        self.width - 1
    }

    fn reserve_rows(&mut self, rows: usize) -> &mut [f64] {
        if self.rows.len() + rows * self.width > BUFFERED_ROWS * self.width {
            self.take_in();
        }
        let start = self.rows.len();
        self.rows.resize(start + rows * self.width, 0.0);
        &mut self.rows[start..]
    }
}

impl NormalEquations {
    /// For P columns.
    pub fn new(columns: usize) -> Self {
        NormalEquations {
            width: columns + 1,
            rows: Vec::new(),
            products: DMatrix::zeros(columns + 1, columns + 1),
        }
    }

    fn take_in(&mut self) {
        let (w, count) = (self.width, self.rows.len() / self.width);
        let across = DMatrixView::from_slice(&self.rows, w, count);
        let rows = transposed(&self.rows, w, count);
        add_products(&mut self.products, &across, &rows);
        self.rows.clear();
    }

    /// The products for unknowns that count from `−x`, not from zero: of the right side b + A x. `x` pairs columns with values.
    /// By rows, the right side last.
    pub fn shifted(mut self, x: &[(usize, f64)]) -> Vec<f64> {
        self.take_in();
        let (w, last) = (self.width, self.width - 1);
        let at = |i: usize, j: usize| self.products[(i.max(j), i.min(j))];
        let mut all: Vec<f64> = (0..w * w).map(|k| at(k / w, k % w)).collect();
        let moved = |i: usize| x.iter().map(|(j, x)| at(i, *j) * x).sum::<f64>();
        for i in 0..last {
            all[i * w + last] += moved(i);
            all[last * w + i] = all[i * w + last];
        }
        // bᵀb + 2 xᵀAᵀb + xᵀAᵀA x
        all[w * w - 1] += moved(last);
        all[w * w - 1] += x.iter().map(|(j, x)| all[j * w + last] * x).sum::<f64>();
        all
    }
}
