//! Range reduction: from a [`Problem`] to the small, scaled matrix that solvers iterate on, and back.
//!
//! In: a dictionary in model units. Out: unit columns (all-zero ones left out), a target of length one, and rows rotated to the left
//! singular vectors, by falling singular value, as many as the numerical rank. The rotation keeps residuals and correlations, and
//! graded rows keep digits that a Cholesky factorisation of dependent rows would lose.

use nalgebra::DMatrix;

use crate::dictionary::{unit_columns, usable_columns};
use crate::linalg::{Range, nonzero, norm, quotient, times, times_transposed};
use crate::problem::Problem;
use crate::simd::axpy;
use crate::thresholds::CERTIFICATES;

/// `min ‖x‖₁ s.t. ‖P x − q‖₂ ≤ ε'` with P = Uᵀ(unit columns), standing for a [`Problem`] with `x = D a / ‖y‖`.
pub(super) struct ReducedProblem {
    /// P, r × n: r the numerical rank, one column for each entry of `kept`.
    pub matrix: DMatrix<f64>,
    /// The lengths of P's rows, descending.
    pub singular_values: Vec<f64>,
    /// q, length r; with `unreachable` it has length one.
    pub target: Vec<f64>,
    /// ‖y‖₂; zero when the target is.
    pub target_norm: f64,
    /// Length of the part of y/‖y‖ that no combination of columns reaches.
    pub unreachable: f64,
    /// ε/‖y‖ for the whole residual.
    pub tolerance: f64,
    kept: Vec<usize>,
    weights: Vec<f64>,
    /// U, M × r.
    basis: DMatrix<f64>,
    /// That part as a unit vector, length M.
    unreachable_direction: Vec<f64>,
}

impl ReducedProblem {
    /// The dictionary, the target and the tolerance must be finite.
    pub fn new(problem: &Problem) -> ReducedProblem {
        let dictionary = problem.dictionary;
        let target_norm = norm(problem.target);
        let kept = usable_columns(dictionary);
        let weights: Vec<f64> = kept.iter().map(|&j| dictionary.weight(j)).collect();
        let unit = unit_columns(dictionary, &kept, &weights);
        let y = quotient(problem.target, nonzero(target_norm));
        let range = Range::new(&unit);
        let mut unreachable_direction = range.outside(&y);
        let unreachable = norm(&unreachable_direction);
        unreachable_direction
            .iter_mut()
            .for_each(|b| *b /= nonzero(unreachable));
        ReducedProblem {
            matrix: range.basis.transpose() * &unit,
            target: times_transposed(&range.basis, &y),
            singular_values: range.values,
            target_norm,
            unreachable,
            tolerance: problem.tolerance / nonzero(target_norm),
            kept,
            weights,
            basis: range.basis,
            unreachable_direction,
        }
    }

    /// ε' of the reduced rows, `√(ε² − unreachable²)`; `None` where the unreachable part alone exceeds ε.
    pub fn reduced_tolerance(&self) -> Option<f64> {
        let (e, c) = (self.tolerance, self.unreachable);
        if e == 0.0 {
            return (c <= CERTIFICATES.consistent).then_some(0.0);
        }
        (c <= e).then(|| ((e - c) * (e + c)).sqrt())
    }

    /// a in model units from x; what is zero or overflows is left out.
    pub fn coefficients(&self, x: &[f64]) -> Vec<(usize, f64)> {
        let raw = self.kept.iter().zip(&self.weights).zip(x);
        raw.map(|((&j, &n), &x)| (j, x * self.target_norm / n))
            .filter(|(_, a)| a.is_finite() && *a != 0.0)
            .collect()
    }

    /// λ on the original rows. With ε > 0 the residual includes the
    /// unreachable part, and so does the dual point, a multiple of the residual.
    pub fn dual(&self, lambda: &[f64]) -> Vec<f64> {
        let mut full = times(&self.basis, lambda);
        let inner = self.reduced_tolerance().unwrap_or(0.0);
        if inner > 0.0 {
            axpy(
                self.unreachable * norm(lambda) / inner,
                &self.unreachable_direction,
                &mut full,
            );
        }
        full
    }
}
