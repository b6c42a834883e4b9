//! The range of a matrix: an orthonormal basis by the singular value decomposition, cut at the numerical rank.

use nalgebra::DMatrix;

use super::products::{times, times_transposed};
use super::qr::Qr;
use super::svd::svd;
use super::vectors::difference;
use crate::thresholds::NUMERICAL_RANK;

/// The range of a matrix: left singular vectors and values up to the numerical rank.
pub struct Range {
    /// U, M × r.
    pub basis: DMatrix<f64>,
    /// Descending, length r.
    pub values: Vec<f64>,
}

impl Range {
    /// QR or LQ to a square core, then its singular value decomposition. Empty for a matrix without a usable entry.
    pub fn new(a: &DMatrix<f64>) -> Range {
        Range::decompose(a).unwrap_or(Range {
            basis: DMatrix::zeros(a.nrows(), 0),
            values: Vec::new(),
        })
    }

    fn decompose(a: &DMatrix<f64>) -> Option<Range> {
        if a.nrows() == 0 || a.ncols() == 0 {
            return None;
        }
        let wide = a.ncols() > a.nrows();
        let qr = Qr::new(if wide { a.transpose() } else { a.clone() });
        let core = svd(qr.r.clone())?;
        let values = core.values;
        let largest = values
            .first()
            .copied()
            .filter(|v| v.is_finite() && *v > 0.0)?;
        let rank = values
            .iter()
            .take_while(|v| **v > NUMERICAL_RANK.singular_value * largest)
            .count();
        let basis = if wide {
            core.v_t.rows(0, rank).transpose()
        } else {
            qr.q_mul(core.u.columns(0, rank).into_owned())
        };
        Some(Range {
            basis,
            values: values.into_iter().take(rank).collect(),
        })
    }

    /// Part of y outside the range, projected twice to keep short ones accurate.
    pub fn outside(&self, y: &[f64]) -> Vec<f64> {
        let project = |v: &[f64]| {
            let inside = times_transposed(&self.basis, v);
            difference(v, &times(&self.basis, &inside))
        };
        project(&project(y))
    }
}
