//! The least-squares fit of a whole library: how much of the target any combination of its terms can explain.
//!
//! In: a dictionary and a target. Out: the smallest residual, one minimiser, the numerical rank. Tells noise from misfit;
//! it never looks for sparsity.

use super::reduce::{Range, nonzero, norm, times_transposed, unit_columns};
use super::{CONSISTENT, Problem, Solution, Status};
use crate::dictionary::Dictionary;

/// `min ‖Φ a − y‖₂` over all of Φ.
#[derive(Clone, Debug)]
pub struct LeastSquares {
    /// The minimiser of least norm in unit columns, by rising column, in units of the raw columns.
    pub coefficients: Vec<(usize, f64)>,
    /// ‖Φ a − y‖₂, in the units of y.
    pub residual: f64,
    /// Numerical rank of Φ with unit columns.
    pub rank: usize,
    /// Largest over smallest singular value counted into the rank.
    pub condition: f64,
}

/// Rank-revealing least squares: QR or LQ to a square core, then its singular value decomposition (Golub & Van Loan,
/// section 5.5). Inputs that are not finite give a residual of ‖y‖ and zero coefficients.
pub fn least_squares(dictionary: &dyn Dictionary, target: &[f64]) -> LeastSquares {
    let norms = dictionary.norms();
    let kept: Vec<usize> = (0..norms.len())
        .filter(|&j| norms[j] > f64::MIN_POSITIVE && norms[j].is_finite())
        .collect();
    let lengths: Vec<f64> = kept.iter().map(|&j| norms[j]).collect();
    let unit = unit_columns(dictionary, &kept, &lengths);
    let size = norm(target);
    let y: Vec<f64> = target.iter().map(|y| y / nonzero(size)).collect();
    let mut fit = LeastSquares {
        coefficients: Vec::new(),
        residual: size,
        rank: 0,
        condition: 1.0,
    };
    let range = Range::new(&unit);
    let (Some(first), Some(last)) = (range.values.first(), range.values.last()) else {
        return fit;
    };
    // Columns may be dependent: the answer of least norm is Pᵀ U Σ⁻² Uᵀ y.
    let mut z = times_transposed(&range.basis, &y);
    let rows = range.basis.transpose() * &unit;
    z.iter_mut()
        .zip(&range.values)
        .for_each(|(z, s)| *z /= s * s);
    let x = times_transposed(&rows, &z);
    if x.iter().all(|x| x.is_finite()) {
        let raw = kept.iter().zip(&lengths).zip(&x);
        fit.coefficients = raw.map(|((&j, &n), x)| (j, x * size / n)).collect();
        fit.residual = size * norm(&range.outside(&y));
        fit.rank = range.values.len();
        fit.condition = first / last;
    }
    fit
}

/// The least-squares answer if no a reaches the tolerance, otherwise what the solver found, which then is at worst inaccurate.
pub(super) fn inconsistent(problem: &Problem, found: Solution) -> Solution {
    let fit = least_squares(problem.dictionary, problem.target);
    let allowed = problem.tolerance.max(CONSISTENT * norm(problem.target));
    if fit.residual <= allowed {
        let status = match found.status {
            Status::Inconsistent { residual } => Status::Inaccurate {
                gap: f64::INFINITY,
                residual: residual / nonzero(norm(problem.target)),
            },
            other => other,
        };
        return Solution { status, ..found };
    }
    Solution {
        coefficients: fit.coefficients,
        dual: vec![0.0; problem.target.len()],
        status: Status::Inconsistent {
            residual: fit.residual,
        },
        iterations: found.iterations,
    }
}
