//! The least-squares fit of a whole library: how much of the target any combination of its terms can explain.
//!
//! In: a dictionary and a target. Out: the smallest residual, one minimiser, the numerical rank. Tells noise from misfit;
//! it never looks for sparsity.

use faer::Mat;
use faer::linalg::solvers::{Qr, Svd};

use super::reduce::{dot, minus, nonzero, norm, times, times_transposed, unit_columns};
use super::{CONSISTENT, Problem, Solution, Status};
use crate::dictionary::Dictionary;

/// Singular values below this part of the largest count as zero: what f64 leaves of columns of length one.
pub const RANK_TOLERANCE: f64 = 1e-13;

/// `min ‖Φ a − y‖₂` over all of Φ.
#[derive(Clone, Debug)]
pub struct LeastSquares {
    /// The minimiser of least norm in unit columns, length N, in units of the raw columns.
    pub coefficients: Vec<f64>,
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
        coefficients: vec![0.0; norms.len()],
        residual: size,
        rank: 0,
        condition: 1.0,
    };
    let Some(core) = Core::new(&unit) else {
        return fit;
    };
    let x = core.solve(&y);
    if x.iter().all(|x| x.is_finite()) {
        for ((&j, &n), x) in kept.iter().zip(&lengths).zip(&x) {
            fit.coefficients[j] = x * size / n;
        }
        fit.residual = size * norm(&core.outside(&y));
        fit.rank = core.rank();
        fit.condition = core.condition();
    }
    fit
}

/// The least-squares answer if no a reaches the tolerance, otherwise what the solver had.
pub(super) fn inconsistent(problem: &Problem, found: Option<Solution>) -> Solution {
    let fit = least_squares(problem.dictionary, problem.target);
    let allowed = problem.tolerance.max(CONSISTENT * norm(problem.target));
    match found {
        Some(solution) if fit.residual <= allowed => solution,
        found => Solution {
            coefficients: fit.coefficients,
            dual: vec![0.0; problem.target.len()],
            status: Status::Inconsistent {
                residual: fit.residual,
            },
            iterations: found.map_or(0, |s| s.iterations),
        },
    }
}

/// P ≈ U Σ Vᵀ cut at the numerical rank.
pub(super) struct Core {
    pub left: Mat<f64>,
    pub values: Vec<f64>,
    pub right: Mat<f64>,
}

impl Core {
    /// `None` for an empty matrix, one that is not finite, or when the decomposition does not converge.
    pub fn new(unit: &Mat<f64>) -> Option<Core> {
        Core::cut(unit, RANK_TOLERANCE)
    }

    /// The same with singular values kept above `tolerance` times the largest.
    pub fn cut(unit: &Mat<f64>, tolerance: f64) -> Option<Core> {
        let (m, n) = (unit.nrows(), unit.ncols());
        if m == 0 || n == 0 {
            return None;
        }
        let wide = n > m;
        let qr = Qr::new(if wide {
            unit.transpose()
        } else {
            unit.as_ref()
        });
        let inner = Svd::new_thin(qr.thin_R()).ok()?;
        let s = inner.S().column_vector();
        let values: Vec<f64> = s.iter().copied().collect();
        let largest = values
            .first()
            .copied()
            .filter(|v| v.is_finite() && *v > 0.0)?;
        let rank = values
            .iter()
            .take_while(|v| **v > tolerance * largest)
            .count();
        let basis = qr.compute_thin_Q();
        let (u, v) = (inner.U().subcols(0, rank), inner.V().subcols(0, rank));
        let rotated = |small| &basis * small;
        let (left, right) = if wide {
            (v.to_owned(), rotated(u))
        } else {
            (rotated(u), v.to_owned())
        };
        Some(Core {
            left,
            values: values.into_iter().take(rank).collect(),
            right,
        })
    }

    pub fn rank(&self) -> usize {
        self.values.len()
    }

    pub fn condition(&self) -> f64 {
        match (self.values.first(), self.values.last()) {
            (Some(first), Some(last)) => first / last,
            _ => 1.0,
        }
    }

    /// Least-norm minimiser.
    fn solve(&self, y: &[f64]) -> Vec<f64> {
        let mut z = times_transposed(self.left.as_ref(), y);
        z.iter_mut().zip(&self.values).for_each(|(z, s)| *z /= s);
        times(self.right.as_ref(), &z)
    }

    /// Part of y outside the range, projected twice to keep small residuals accurate.
    pub fn outside(&self, y: &[f64]) -> Vec<f64> {
        let project = |v: &[f64]| {
            minus(
                v,
                &times(self.left.as_ref(), &times_transposed(self.left.as_ref(), v)),
            )
        };
        let once = project(y);
        if dot(&once, &once) == 0.0 {
            once
        } else {
            project(&once)
        }
    }
}
