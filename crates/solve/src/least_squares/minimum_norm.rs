//! Least squares on a whole library: how much of the target any combination of its columns can explain.
//!
//! In: a dictionary and a target. Out: the least residual, the minimiser of least norm, the numerical rank. Never sparse.

use crate::dictionary::{Dictionary, unit_columns};
use crate::linalg::{Range, nonzero, norm, quotient, times_transposed};

/// `min ‖Φ a − y‖₂` over all of Φ.
#[derive(Clone, Debug)]
pub struct LeastSquares {
    /// The minimiser of least norm in unit columns, by rising column, in units of the raw columns.
    pub coefficients: Vec<(usize, f64)>,
    /// ‖Φ a − y‖₂, in the units of y.
    pub residual: f64,
    /// The part of y off the columns, length M. Where columns are nearly dependent, Φ a has lost it to rounding.
    pub rest: Vec<f64>,
    /// Numerical rank of Φ with unit columns.
    pub rank: usize,
    /// Largest over smallest singular value that counts into the rank.
    pub condition: f64,
}

/// Least squares of least norm: QR or LQ to a square core, then its singular value decomposition (Golub & Van Loan,
/// section 5.5). Inputs that are not finite give a residual of ‖y‖ and zero coefficients.
pub fn minimum_norm_least_squares(dictionary: &dyn Dictionary, target: &[f64]) -> LeastSquares {
    let norms = (0..dictionary.cols()).map(|j| (j, dictionary.norm(j)));
    let (kept, lengths): (Vec<usize>, Vec<f64>) = norms
        .filter(|(_, n)| *n > f64::MIN_POSITIVE && n.is_finite())
        .unzip();
    let unit = unit_columns(dictionary, &kept, &lengths);
    let size = norm(target);
    let y = quotient(target, nonzero(size));
    let mut fit = LeastSquares {
        coefficients: Vec::new(),
        residual: size,
        rest: target.to_vec(),
        rank: 0,
        condition: 1.0,
    };
    let range = Range::new(&unit);
    let (Some(first), Some(last)) = (range.values.first(), range.values.last()) else {
        return fit;
    };
    // The minimiser of least norm is Pᵀ U Σ⁻² Uᵀ y, P the unit columns.
    let mut z = times_transposed(&range.basis, &y);
    let rows = range.basis.transpose() * &unit;
    z.iter_mut()
        .zip(&range.values)
        .for_each(|(z, s)| *z /= s * s);
    let x = times_transposed(&rows, &z);
    if x.iter().all(|x| x.is_finite()) {
        let raw = kept.iter().zip(&lengths).zip(&x);
        fit.coefficients = raw.map(|((&j, &n), x)| (j, x * size / n)).collect();
        fit.rest = range.outside(&y).iter().map(|r| size * r).collect();
        fit.residual = norm(&fit.rest);
        fit.rank = range.values.len();
        fit.condition = first / last;
    }
    fit
}
