//! The rows of one equation as the triangle R of [Φ y] = Q R.
//!
//! In: factors of other rows. Out: a factor of all of them (tall-skinny QR: Demmel, Grigori, Hoemmen & Langou 2012,
//! SIAM J. Sci. Comput. 34, A206). Sums of products would lose half of the digits of clean data.

use nalgebra::DMatrix;
use sidc_solve::linalg::Qr;

/// Any number of rows of one equation with N candidate terms: R is (N + 1) × (N + 1), its last column that of the target.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    rows: usize,
    /// Those of them whose target was estimated, not measured.
    estimated: usize,
    r: DMatrix<f64>,
}

/// R of the rows of a square triangle and others below it.
pub(super) fn triangle_below(triangle: &DMatrix<f64>, below: &DMatrix<f64>) -> DMatrix<f64> {
    let n = triangle.ncols();
    let mut stacked = DMatrix::zeros(n + below.nrows(), n);
    stacked.rows_mut(0, n).copy_from(triangle);
    stacked.rows_mut(n, below.nrows()).copy_from(below);
    Qr::new(stacked).r
}

impl Factor {
    /// `r` is square.
    pub(super) fn new(rows: usize, estimated: usize, r: DMatrix<f64>) -> Factor {
        Factor { rows, estimated, r }
    }

    /// Adds the rows of another factor of as many terms.
    pub fn merge(&mut self, other: &Factor) {
        self.r = triangle_below(&self.r, &other.r);
        self.rows += other.rows;
        self.estimated += other.estimated;
    }

    /// Rows M that were reduced.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Rows whose target was estimated, not measured.
    pub fn estimated(&self) -> usize {
        self.estimated
    }

    /// Candidate terms N.
    pub fn terms(&self) -> usize {
        self.r.ncols() - 1
    }

    /// R.
    pub(crate) fn r(&self) -> &DMatrix<f64> {
        &self.r
    }

    /// R, column by column, each down to its diagonal: (N + 1)(N + 2)/2 numbers.
    pub fn packed(&self) -> Vec<f64> {
        let column = |j: usize| {
            self.r
                .column(j)
                .iter()
                .take(j + 1)
                .copied()
                .collect::<Vec<_>>()
        };
        (0..self.r.ncols()).flat_map(column).collect()
    }

    /// The factor of these numbers; `None` if there are too few or too many, or one is not finite.
    pub fn unpacked(
        (rows, estimated): (usize, usize),
        terms: usize,
        packed: &[f64],
    ) -> Option<Factor> {
        let n = terms.checked_add(1)?;
        let length = n.checked_mul(n + 1)? / 2;
        if packed.len() != length || packed.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let entry = |i: usize, j: usize| match i <= j {
            true => packed[j * (j + 1) / 2 + i],
            false => 0.0,
        };
        let r = DMatrix::from_fn(n, n, entry);
        Some(Factor { rows, estimated, r })
    }
}
