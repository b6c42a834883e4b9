//! The refit: least squares on a chosen support, with standard errors, rank and condition number.
//!
//! In: a dictionary, a target and column indices. Out: coefficients in raw units. It never changes the support.

use crate::dictionary::{Dictionary, unit_columns};
use crate::linalg::{RankRevealingQr, condition_number, difference, nonzero, norm, times};
use crate::simd::axpy;
use crate::statistics::Autoregression;

/// The least-squares fit on a support.
#[derive(Clone, Debug)]
pub struct Refit {
    /// One coefficient for each entry of the support, in the units of the raw columns; zero for a dependent column.
    pub coefficients: Vec<f64>,
    /// ‖Φ a − y‖₂ in the units of y.
    pub residual: f64,
    /// Numerical rank of the support's unit columns.
    pub rank: usize,
    /// Their condition number; infinite when they are dependent.
    pub condition: f64,
    /// √(σ² Φ⁺ S Φ⁺ᵀ)_jj with σ² = rss/(M − k) and S the correlation matrix of the residuals ([`Autoregression`]), at least the
    /// value for white residuals; in the units of the coefficients; infinite where the data do not determine one.
    pub standard_errors: Vec<f64>,
}

/// Fits y on the columns of `support` by pivoted Householder QR of the unit columns and one step of iterative refinement
/// (Golub & Van Loan, sections 5.4 and 5.5). Indices past the last column are ignored like all-zero columns.
///
/// ```
/// use sidc_solve::dictionary::Dense;
/// use sidc_solve::refit;
///
/// // Columns (1, 1, 1) and (0, 1, 2): the straight line through (0, 1), (1, 3), (2, 5).
/// let phi = Dense::new(3, vec![1.0, 1.0, 1.0, 0.0, 1.0, 2.0]);
/// let fit = refit(&phi, &[1.0, 3.0, 5.0], &[0, 1]);
/// assert!((fit.coefficients[0] - 1.0).abs() < 1e-12 && (fit.coefficients[1] - 2.0).abs() < 1e-12);
/// assert_eq!(fit.rank, 2);
/// ```
pub fn refit(dictionary: &dyn Dictionary, target: &[f64], support: &[usize]) -> Refit {
    let norms: Vec<f64> = support.iter().map(|&j| dictionary.norm(j)).collect();
    let usable: Vec<usize> = (0..support.len())
        .filter(|&k| norms[k] > f64::MIN_POSITIVE && norms[k].is_finite())
        .collect();
    let columns: Vec<usize> = usable.iter().map(|&k| support[k]).collect();
    let lengths: Vec<f64> = usable.iter().map(|&k| norms[k]).collect();
    let unit = unit_columns(dictionary, &columns, &lengths);
    let mut fit = Refit {
        coefficients: vec![0.0; support.len()],
        residual: norm(target),
        rank: 0,
        condition: if columns.len() == support.len() {
            1.0
        } else {
            f64::INFINITY
        },
        standard_errors: vec![f64::INFINITY; support.len()],
    };
    let Some(qr) = RankRevealingQr::new(&unit) else {
        return fit;
    };
    let mut x = qr.solve(target);
    let residual = difference(target, &times(&unit, &x));
    axpy(1.0, &qr.solve(&residual), &mut x);
    let residual = difference(target, &times(&unit, &x));
    fit.residual = norm(&residual);
    fit.rank = qr.rank;
    fit.condition = if qr.rank == support.len() {
        condition_number(&unit)
    } else {
        f64::INFINITY
    };
    let degrees_of_freedom = target.len().saturating_sub(qr.rank);
    let deviation = fit.residual / (degrees_of_freedom as f64).sqrt();
    let unit_errors = unit_errors(&qr, &Autoregression::fit(&[residual]));
    for (k, at) in usable.into_iter().enumerate() {
        fit.coefficients[at] = x[k] / lengths[k];
        let error = deviation * unit_errors[k] / lengths[k];
        fit.standard_errors[at] = if error.is_nan() { f64::INFINITY } else { error };
    }
    fit
}

/// The standard error of each coefficient for errors of variance one: the root of the variance of its row of P⁺ times the errors.
/// Infinite at dependent columns.
fn unit_errors(qr: &RankRevealingQr, errors: &Autoregression) -> Vec<f64> {
    let mut found = vec![f64::INFINITY; qr.columns().len()];
    for &at in qr.independent() {
        let mut unit = vec![0.0; qr.columns().len()];
        unit[at] = 1.0;
        let weights = qr.least_norm(&unit);
        let white: f64 = weights.iter().map(|w| w * w).sum();
        // Never below the error for white errors. Negative autocorrelation mostly comes from estimated derivatives, whose errors
        // are systematic: no coefficient is known better for it.
        found[at] = nonzero(errors.variance(&weights).max(white).sqrt());
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dictionary::Dense;

    #[test]
    fn straight_line_with_textbook_standard_errors() {
        // y = 1 + 2t + (1, −1, −1, 1)/10: the disturbance is orthogonal to 1 and t.
        let t = [0.0, 1.0, 2.0, 3.0];
        let phi = Dense::new(4, [vec![1.0; 4], t.to_vec()].concat());
        let y: Vec<f64> = t
            .iter()
            .zip([0.1, -0.1, -0.1, 0.1])
            .map(|(t, e)| 1.0 + 2.0 * t + e)
            .collect();
        let fit = refit(&phi, &y, &[1, 0]);
        assert!(
            (fit.coefficients[0] - 2.0).abs() < 1e-14 && (fit.coefficients[1] - 1.0).abs() < 1e-14
        );
        assert!((fit.residual - 0.2).abs() < 1e-14);
        assert_eq!(fit.rank, 2);
        // σ² = 0.04/2; var(slope) = σ²/Σ(t − t̄)² = 0.02/5, var(constant) = σ²(1/4 + t̄²/5).
        assert!((fit.standard_errors[0] - (0.02_f64 / 5.0).sqrt()).abs() < 1e-14);
        assert!((fit.standard_errors[1] - (0.02_f64 * (0.25 + 2.25 / 5.0)).sqrt()).abs() < 1e-14);
    }

    #[test]
    fn dependent_and_zero_columns_lower_the_rank() {
        let phi = Dense::new(3, vec![1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 0.0]);
        let fit = refit(&phi, &[1.0, 2.0, 3.0], &[0, 1, 2]);
        assert_eq!(fit.rank, 1);
        assert!(fit.residual < 1e-14 && fit.condition.is_infinite());
        assert_eq!(
            fit.standard_errors.iter().filter(|e| e.is_finite()).count(),
            1
        );
    }

    #[test]
    fn empty_support_leaves_the_target() {
        let phi = Dense::new(2, vec![1.0, 0.0]);
        let fit = refit(&phi, &[3.0, 4.0], &[]);
        assert_eq!((fit.residual, fit.rank, fit.condition), (5.0, 0, 1.0));
    }
}
