//! Least squares on a chosen support, and what it says about the coefficients: standard errors, rank, condition.
//!
//! In: a dictionary, a target and column indices. Out: coefficients in raw units. It never changes the support.

use nalgebra::DMatrix;

use super::memory::Memory;
use super::reduce::{add_scaled, minus, nonzero, norm, times, unit_columns};
use crate::dictionary::Dictionary;
use crate::linalg::{ColPivQr, Qr, svd};

/// Pivots below this part of the first count as dependent columns.
const DEPENDENT: f64 = 1e-11;

/// A least-squares fit on a support.
#[derive(Clone, Debug)]
pub struct Polished {
    /// One coefficient for each entry of the support, in the units of the raw columns; zero for a dependent column.
    pub coefficients: Vec<f64>,
    /// ‖Φ a − y‖₂ in the units of y.
    pub residual: f64,
    /// Numerical rank of the support's unit columns.
    pub rank: usize,
    /// Their condition number; infinite when they are dependent.
    pub condition: f64,
    /// √(σ² Φ⁺ S Φ⁺ᵀ)_jj with σ² = rss/(M − k) and S the correlations of the residuals, 1 on the diagonal and 0 elsewhere where they are white
    /// ([`Memory`]), never under that of white ones; in the units of the coefficients; infinite where data cannot say.
    pub standard_errors: Vec<f64>,
}

/// Fits y on the columns of `support` by pivoted Householder QR of the unit columns and one step of iterative refinement
/// (Golub & Van Loan, sections 5.4 and 5.5). Indices past the last column are ignored like all-zero columns.
///
/// ```
/// use sidc_solve::dictionary::Dense;
/// use sidc_solve::polish;
///
/// // Columns (1, 1, 1) and (0, 1, 2): the straight line through (0, 1), (1, 3), (2, 5).
/// let phi = Dense::new(3, vec![1.0, 1.0, 1.0, 0.0, 1.0, 2.0]);
/// let fit = polish(&phi, &[1.0, 3.0, 5.0], &[0, 1]);
/// assert!((fit.coefficients[0] - 1.0).abs() < 1e-12 && (fit.coefficients[1] - 2.0).abs() < 1e-12);
/// assert_eq!(fit.rank, 2);
/// ```
pub fn polish(dictionary: &dyn Dictionary, target: &[f64], support: &[usize]) -> Polished {
    let norms: Vec<f64> = support
        .iter()
        .map(|&j| dictionary.norms().get(j).copied().unwrap_or(0.0))
        .collect();
    let usable: Vec<usize> = (0..support.len())
        .filter(|&k| norms[k] > f64::MIN_POSITIVE && norms[k].is_finite())
        .collect();
    let columns: Vec<usize> = usable.iter().map(|&k| support[k]).collect();
    let lengths: Vec<f64> = usable.iter().map(|&k| norms[k]).collect();
    let unit = unit_columns(dictionary, &columns, &lengths);
    let mut polished = Polished {
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
    let Some(fit) = Pivoted::new(&unit) else {
        return polished;
    };
    let mut x = fit.solve(target);
    let residual = minus(target, &times(&unit, &x));
    add_scaled(&mut x, 1.0, &fit.solve(&residual));
    let left = minus(target, &times(&unit, &x));
    polished.residual = norm(&left);
    polished.rank = fit.rank;
    polished.condition = if fit.rank == support.len() {
        condition(&unit)
    } else {
        f64::INFINITY
    };
    let freedom = target.len().saturating_sub(fit.rank);
    let deviation = polished.residual / (freedom as f64).sqrt();
    let spread = fit.spread(&Memory::of(&[left]));
    for (k, at) in usable.into_iter().enumerate() {
        polished.coefficients[at] = x[k] / lengths[k];
        let error = deviation * spread[k] / lengths[k];
        polished.standard_errors[at] = if error.is_nan() { f64::INFINITY } else { error };
    }
    polished
}

/// Largest over smallest singular value; infinite when the columns outnumber the rows or are dependent.
pub(super) fn condition(unit: &DMatrix<f64>) -> f64 {
    if unit.ncols() == 0 {
        return 1.0;
    }
    if unit.ncols() > unit.nrows() {
        return f64::INFINITY;
    }
    let Some(svd) = svd(Qr::new(unit.clone()).r) else {
        return f64::INFINITY;
    };
    match (svd.values.first(), svd.values.last()) {
        (Some(most), Some(least)) if *least > 0.0 => most / least,
        _ => f64::INFINITY,
    }
}

/// P Π = Q R, cut at the numerical rank.
pub(super) struct Pivoted {
    qr: ColPivQr,
    pub rank: usize,
}

impl Pivoted {
    /// `None` for an empty matrix or one that is not finite.
    pub fn new(unit: &DMatrix<f64>) -> Option<Pivoted> {
        if unit.nrows() == 0 || unit.ncols() == 0 {
            return None;
        }
        let qr = ColPivQr::new(unit.nrows(), unit.as_slice().to_vec());
        let first = qr.r(0, 0).abs();
        if !(first > 0.0 && first.is_finite()) {
            return None;
        }
        let size = unit.nrows().min(unit.ncols());
        let rank = (0..size)
            .take_while(|&i| qr.r(i, i).abs() > DEPENDENT * first)
            .count();
        Some(Pivoted { qr, rank })
    }

    /// Least-squares solution with zeros at dependent columns.
    pub fn solve(&self, y: &[f64]) -> Vec<f64> {
        let mut z = self.qr.q_tr_mul(y.to_vec());
        z.truncate(self.rank);
        for i in (0..self.rank).rev() {
            let known: f64 = (i + 1..self.rank).map(|j| self.qr.r(i, j) * z[j]).sum();
            z[i] = (z[i] - known) / self.qr.r(i, i);
        }
        let mut x = vec![0.0; self.qr.order.len()];
        for (z, &at) in z.iter().zip(&self.qr.order) {
            x[at] = *z;
        }
        x
    }

    /// The δ of least norm with Pᵀ δ = c on the independent columns.
    pub fn least_norm(&self, c: &[f64]) -> Vec<f64> {
        let mut z: Vec<f64> = self
            .qr
            .order
            .iter()
            .take(self.rank)
            .map(|&at| c[at])
            .collect();
        for i in 0..z.len() {
            let known: f64 = (0..i).map(|j| self.qr.r(j, i) * z[j]).sum();
            z[i] = (z[i] - known) / self.qr.r(i, i);
        }
        self.qr.q_mul(z)
    }

    /// What errors of variance one with this memory do to each coefficient: for white ones the length of its row of P⁺. Infinite at
    /// dependent columns.
    fn spread(&self, memory: &Memory) -> Vec<f64> {
        let mut spread = vec![f64::INFINITY; self.qr.order.len()];
        for &at in self.qr.order.iter().take(self.rank) {
            let mut unit = vec![0.0; self.qr.order.len()];
            unit[at] = 1.0;
            let weights = self.least_norm(&unit);
            let white: f64 = weights.iter().map(|w| w * w).sum();
            // Errors that cancel from row to row are mostly those of estimated derivatives, which noise does not make:
            // they are off in one direction, and no coefficient is known better for it.
            spread[at] = nonzero(memory.square(&weights).max(white).sqrt());
        }
        spread
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dictionary::Dense;

    #[test]
    fn conditions_are_ratios_of_singular_values() {
        let diagonal = DMatrix::from_fn(4, 3, |i, j| match i == j {
            true => [2.0, 0.5, 1.0][i],
            false => 0.0,
        });
        assert!((condition(&diagonal) - 4.0).abs() < 1e-14);
        assert_eq!(condition(&diagonal.transpose()), f64::INFINITY);
        assert_eq!(condition(&DMatrix::zeros(3, 0)), 1.0);
        assert_eq!(condition(&DMatrix::zeros(3, 2)), f64::INFINITY);
    }

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
        let fit = polish(&phi, &y, &[1, 0]);
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
        let fit = polish(&phi, &[1.0, 2.0, 3.0], &[0, 1, 2]);
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
        let fit = polish(&phi, &[3.0, 4.0], &[]);
        assert_eq!((fit.residual, fit.rank, fit.condition), (5.0, 0, 1.0));
    }
}
