//! From a [`Problem`] to the small, scaled matrix that solvers iterate on, and back.
//!
//! In: a dictionary in model units. Out: unit columns (all-zero ones left out), a target of length one, and at most as
//! many rows as there are columns: tall problems are rotated by an orthogonal factorisation, which changes neither
//! residuals nor correlations. It never drops a row or a column that carries information.

use faer::linalg::solvers::Qr;
use faer::{Mat, MatRef};

use super::Problem;
use crate::dictionary::Dictionary;

/// A column shorter than this is treated as all zero: its reciprocal would overflow.
const SHORTEST: f64 = 1e-290;

/// `min ‖x‖₁ s.t. ‖P x − q‖₂ ≤ ε'` with unit columns P, standing for a [`Problem`] with `x = D a / ‖y‖`.
pub(super) struct Reduced {
    /// P, m × n: `m = min(M, n + 1)` rows at most, one column for each entry of `kept`.
    pub unit: Mat<f64>,
    /// q, length m; together with `leftover` it has length one.
    pub target: Vec<f64>,
    /// ‖y‖₂; zero when the target is.
    pub size: f64,
    /// Part of y/‖y‖ that no column reaches because it is orthogonal to all of them (tall problems only).
    pub leftover: f64,
    /// ε/‖y‖ for the whole residual.
    pub tolerance: f64,
    kept: Vec<usize>,
    norms: Vec<f64>,
    cols: usize,
    rotation: Option<Rotation>,
}

/// What maps reduced rows back to the original ones.
struct Rotation {
    /// M × m, orthonormal columns.
    basis: Mat<f64>,
    /// Unit vector of the leftover part of y, length M.
    beyond: Vec<f64>,
}

impl Reduced {
    /// `None` if the dictionary, the target or the tolerance holds a value that is not finite, or no usable column.
    pub fn new(problem: &Problem) -> Option<Reduced> {
        let dictionary = problem.dictionary;
        let size = norm(problem.target);
        let finite = dictionary.norms().iter().all(|n| n.is_finite());
        if !finite || !size.is_finite() || !problem.tolerance.is_finite() {
            return None;
        }
        let kept = usable(dictionary);
        let norms: Vec<f64> = kept.iter().map(|&j| dictionary.norms()[j]).collect();
        let unit = unit_columns(dictionary, &kept, &norms);
        let target = problem.target.iter().map(|y| y / nonzero(size)).collect();
        let mut reduced = Reduced {
            unit,
            target,
            size,
            leftover: 0.0,
            tolerance: problem.tolerance / nonzero(size),
            kept,
            norms,
            cols: dictionary.cols(),
            rotation: None,
        };
        if reduced.unit.ncols() > 0 && reduced.unit.nrows() > reduced.unit.ncols() {
            reduced.rotate();
        }
        Some(reduced)
    }

    /// Replaces P, q by R, Qᵀq of P = QR and keeps the length of what is orthogonal to all columns.
    fn rotate(&mut self) {
        let qr = Qr::new(self.unit.as_ref());
        let basis = qr.compute_thin_Q();
        let y = &self.target;
        let inside = times_transposed(basis.as_ref(), y);
        // A second projection keeps the leftover orthogonal to the basis when it is tiny.
        let mut beyond = minus(y, &times(basis.as_ref(), &inside));
        let again = times_transposed(basis.as_ref(), &beyond);
        beyond = minus(&beyond, &times(basis.as_ref(), &again));
        self.leftover = norm(&beyond);
        let length = nonzero(self.leftover);
        beyond.iter_mut().for_each(|b| *b /= length);
        self.unit = qr.thin_R().to_owned();
        self.target = inside.iter().zip(&again).map(|(a, b)| a + b).collect();
        self.rotation = Some(Rotation { basis, beyond });
    }

    /// ε' of the reduced rows, `√(ε² − leftover²)`; `None` when the leftover alone exceeds ε.
    pub fn inner_tolerance(&self) -> Option<f64> {
        let (e, c) = (self.tolerance, self.leftover);
        if e == 0.0 {
            return (c <= super::CONSISTENT).then_some(0.0);
        }
        (c <= e).then(|| ((e - c) * (e + c)).sqrt())
    }

    /// a in model units, length N, from x.
    pub fn coefficients(&self, x: &[f64]) -> Vec<f64> {
        let mut a = vec![0.0; self.cols];
        for ((&j, &n), &x) in self.kept.iter().zip(&self.norms).zip(x) {
            let value = x * self.size / n;
            a[j] = if value.is_finite() { value } else { 0.0 };
        }
        a
    }

    /// λ on the original rows. With a leftover c and ε > 0 the dual has a part along it too, `c/δ` with `δ = ε'/‖λ'‖`.
    pub fn dual(&self, lambda: &[f64]) -> Vec<f64> {
        let Some(rotation) = &self.rotation else {
            return lambda.to_vec();
        };
        let mut full = times(rotation.basis.as_ref(), lambda);
        let inner = self.inner_tolerance().unwrap_or(0.0);
        if inner > 0.0 {
            let along = self.leftover * norm(lambda) / inner;
            for (f, b) in full.iter_mut().zip(&rotation.beyond) {
                *f += along * b;
            }
        }
        full
    }
}

/// Indices of the columns that are not all zero.
fn usable(dictionary: &dyn Dictionary) -> Vec<usize> {
    let norms = dictionary.norms();
    (0..norms.len()).filter(|&j| norms[j] > SHORTEST).collect()
}

/// The chosen columns, each divided by its norm.
pub(super) fn unit_columns(dictionary: &dyn Dictionary, kept: &[usize], norms: &[f64]) -> Mat<f64> {
    let mut unit = Mat::zeros(dictionary.rows(), kept.len());
    let mut column = vec![0.0; dictionary.rows()];
    for (k, (&j, &length)) in kept.iter().zip(norms).enumerate() {
        dictionary.column(j, &mut column);
        for (entry, value) in unit.col_mut(k).iter_mut().zip(&column) {
            *entry = value / length;
        }
    }
    unit
}

/// `A v`
pub(super) fn times(a: MatRef<f64>, v: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; a.nrows()];
    faer::linalg::matmul::matmul(
        faer::ColMut::from_slice_mut(&mut out).as_mat_mut(),
        faer::Accum::Replace,
        a,
        faer::ColRef::from_slice(v).as_mat(),
        1.0,
        faer::Par::Seq,
    );
    out
}

/// `Aᵀ v`
pub(super) fn times_transposed(a: MatRef<f64>, v: &[f64]) -> Vec<f64> {
    times(a.transpose(), v)
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
