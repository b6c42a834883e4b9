//! From a [`Problem`] to the small, scaled matrix that solvers iterate on, and back.
//!
//! In: a dictionary in model units. Out: unit columns (all-zero ones left out), a target of length one, and rows rotated
//! to singular directions, strongest first, as many as the numerical rank. A rotation changes neither residuals nor
//! correlations; graded rows keep the digits that numerically dependent ones would lose in a Cholesky factorisation.

use nalgebra::DMatrix;

use super::Problem;
use crate::dictionary::Dictionary;
use crate::linalg::{self, Qr, svd};

/// A column shorter than this is treated as all zero: its reciprocal would overflow.
pub(super) const SHORTEST: f64 = 1e-290;
/// Singular values below this part of the largest count as zero: what f64 leaves of columns of length one.
const RANK_TOLERANCE: f64 = 1e-13;

/// `min ‖x‖₁ s.t. ‖P x − q‖₂ ≤ ε'` with P = Uᵀ(unit columns), standing for a [`Problem`] with `x = D a / ‖y‖`.
pub(super) struct Reduced {
    /// P, r × n: r the numerical rank, one column for each entry of `kept`.
    pub matrix: DMatrix<f64>,
    /// Singular values, the lengths of P's rows; descending.
    pub strengths: Vec<f64>,
    /// q, length r; together with `leftover` it has length one.
    pub target: Vec<f64>,
    /// ‖y‖₂; zero when the target is.
    pub size: f64,
    /// Length of the part of y/‖y‖ that no combination of columns reaches.
    pub leftover: f64,
    /// ε/‖y‖ for the whole residual.
    pub tolerance: f64,
    kept: Vec<usize>,
    norms: Vec<f64>,
    /// U, M × r.
    basis: DMatrix<f64>,
    /// The leftover part as a unit vector, length M.
    beyond: Vec<f64>,
}

impl Reduced {
    /// The dictionary, the target and the tolerance must be finite.
    pub fn new(problem: &Problem) -> Reduced {
        let dictionary = problem.dictionary;
        let size = norm(problem.target);
        let kept = usable(dictionary);
        let norms: Vec<f64> = kept.iter().map(|&j| dictionary.norms()[j]).collect();
        let unit = unit_columns(dictionary, &kept, &norms);
        let y: Vec<f64> = problem.target.iter().map(|y| y / nonzero(size)).collect();
        let range = Range::new(&unit);
        let mut beyond = range.outside(&y);
        let leftover = norm(&beyond);
        beyond.iter_mut().for_each(|b| *b /= nonzero(leftover));
        Reduced {
            matrix: range.basis.transpose() * &unit,
            target: times_transposed(&range.basis, &y),
            strengths: range.values,
            size,
            leftover,
            tolerance: problem.tolerance / nonzero(size),
            kept,
            norms,
            basis: range.basis,
            beyond,
        }
    }

    /// ε' of the reduced rows, `√(ε² − leftover²)`; `None` when the leftover alone exceeds ε.
    pub fn inner_tolerance(&self) -> Option<f64> {
        let (e, c) = (self.tolerance, self.leftover);
        if e == 0.0 {
            return (c <= super::CONSISTENT).then_some(0.0);
        }
        (c <= e).then(|| ((e - c) * (e + c)).sqrt())
    }

    /// a in model units from x; what is zero or overflows is left out.
    pub fn coefficients(&self, x: &[f64]) -> Vec<(usize, f64)> {
        let raw = self.kept.iter().zip(&self.norms).zip(x);
        raw.map(|((&j, &n), &x)| (j, x * self.size / n))
            .filter(|(_, a)| a.is_finite() && *a != 0.0)
            .collect()
    }

    /// λ on the original rows. With a leftover c and ε > 0 the dual has a part along it too, `c/δ` with `δ = ε'/‖λ'‖`.
    pub fn dual(&self, lambda: &[f64]) -> Vec<f64> {
        let mut full = times(&self.basis, lambda);
        let inner = self.inner_tolerance().unwrap_or(0.0);
        if inner > 0.0 {
            add_scaled(
                &mut full,
                self.leftover * norm(lambda) / inner,
                &self.beyond,
            );
        }
        full
    }
}

/// The range of a matrix: left singular vectors and values up to the numerical rank.
pub(super) struct Range {
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
            .take_while(|v| **v > RANK_TOLERANCE * largest)
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
            minus(v, &times(&self.basis, &inside))
        };
        project(&project(y))
    }
}

/// Indices of the columns that are not all zero.
pub(super) fn usable(dictionary: &dyn Dictionary) -> Vec<usize> {
    let norms = dictionary.norms();
    (0..norms.len()).filter(|&j| norms[j] > SHORTEST).collect()
}

/// The chosen columns, each divided by its norm.
pub(super) fn unit_columns(
    dictionary: &dyn Dictionary,
    kept: &[usize],
    norms: &[f64],
) -> DMatrix<f64> {
    let mut unit = DMatrix::zeros(dictionary.rows(), kept.len());
    let mut column = vec![0.0; dictionary.rows()];
    for (k, (&j, &length)) in kept.iter().zip(norms).enumerate() {
        dictionary.column(j, &mut column);
        for (entry, value) in unit.column_mut(k).iter_mut().zip(&column) {
            *entry = value / length;
        }
    }
    unit
}

/// `A v`
pub(super) fn times(a: &DMatrix<f64>, v: &[f64]) -> Vec<f64> {
    linalg::gemv(a.as_slice(), a.nrows(), v)
}

/// `Aᵀ v`
pub(super) fn times_transposed(a: &DMatrix<f64>, v: &[f64]) -> Vec<f64> {
    linalg::gemv_tr(a.as_slice(), a.nrows(), v)
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// `y += a x`
pub(super) fn add_scaled(y: &mut [f64], a: f64, x: &[f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}

/// Euclidean length without overflow.
pub(super) fn norm(v: &[f64]) -> f64 {
    let largest = v.iter().fold(
        0.0_f64,
        |m, x| if x.is_nan() { f64::NAN } else { m.max(x.abs()) },
    );
    if largest == 0.0 || !largest.is_finite() {
        return if v.iter().any(|x| x.is_nan()) {
            f64::NAN
        } else {
            largest
        };
    }
    largest * v.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt()
}

/// The value itself, or one where it is zero: a safe divisor.
pub(super) fn nonzero(x: f64) -> f64 {
    if x > 0.0 { x } else { 1.0 }
}
