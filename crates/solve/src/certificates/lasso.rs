//! The optimality certificate of the Lasso.
//!
//! Weak duality: with |φ_jᵀλ| ≤ ‖φ_j‖ every a has `½‖Φa − y‖² + τ‖Da‖₁ ≥ τ yᵀλ − ½τ²‖λ‖²` (Boyd & Vandenberghe, section 5.2; Kim,
//! Koh, Lustig, Boyd & Gorinevsky 2007, section III). Any λ is scaled into that set.

use crate::linalg::{nonzero, norm};
use crate::problem::Problem;
use crate::simd::dot;
use crate::thresholds::CERTIFICATES;

/// What can be said about (a, λ) at one penalty. Values are divided by τ, which leaves basis pursuit at τ = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct LassoCertificate {
    /// ‖Da‖₁ + ‖Φa − y‖²/2τ
    pub primal: f64,
    /// yᵀλ − ½τ‖λ‖², after scaling λ: a lower bound on the minimum.
    pub dual: f64,
    /// (primal − dual)/primal; infinite at τ = 0 if a does not explain y.
    pub gap: f64,
    /// ‖Φa − y‖₂ in the units of y.
    pub residual: f64,
    /// max |φ_jᵀλ|/‖φ_j‖ over all columns, of λ as given.
    pub largest_correlation: f64,
}

/// Checks `coefficients` (column, value in raw units; zeros left out) and `dual` (length M) as an answer of
/// `min ½‖Φa − y‖₂² + τ‖D a‖₁` with τ = `penalty` ≥ 0 in the units of y. The problem's own ε is ignored. One pricing of all columns.
pub fn certify_lasso(
    problem: &Problem,
    penalty: f64,
    coefficients: &[(usize, f64)],
    dual: &[f64],
) -> LassoCertificate {
    let residual = norm(&problem.residual(coefficients));
    let largest_correlation = problem.dictionary.price(dual, 1, 0.0).largest();
    let one_norm: f64 = problem.contributions(coefficients).sum();
    let primal = one_norm + misfit(residual, penalty, norm(problem.target));
    let (along, length) = (dot(problem.target, dual), norm(dual));
    let mut scale = 1.0 / largest_correlation.max(1.0);
    if penalty > 0.0 {
        // The multiple of λ with the largest dual value.
        scale = scale.min((along / nonzero(penalty * length * length)).max(0.0));
    }
    let dual = scale * along - 0.5 * penalty * (scale * length).powi(2);
    LassoCertificate {
        primal,
        dual,
        gap: if primal.is_finite() {
            (primal - dual) / nonzero(primal)
        } else {
            f64::INFINITY
        },
        residual,
        largest_correlation,
    }
}

/// ‖r‖²/2τ
fn misfit(residual: f64, penalty: f64, size: f64) -> f64 {
    match penalty > 0.0 {
        true => 0.5 * residual * (residual / penalty),
        false if residual <= CERTIFICATES.consistent * size => 0.0,
        false => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dictionary::Dense;

    #[test]
    fn soft_thresholds_are_optimal_and_nothing_else_is() {
        // Orthogonal columns of length 2 and 1: shares are |y| − τ where that is positive.
        let phi = Dense::new(2, vec![2.0, 0.0, 0.0, 1.0]);
        let problem = Problem {
            dictionary: &phi,
            target: &[4.0, 0.5],
            tolerance: 0.0,
        };
        let dual = [1.0, 0.5];
        let right = certify_lasso(&problem, 1.0, &[(0, 1.5)], &dual);
        assert!(right.gap.abs() < 1e-15, "{right:?}");
        // ½(1 + 0.25) + 3
        assert_eq!((right.primal, right.largest_correlation), (3.625, 1.0));
        for wrong in [vec![(0, 1.4)], vec![(0, 1.5), (1, 0.1)], vec![]] {
            assert!(certify_lasso(&problem, 1.0, &wrong, &dual).gap > 1e-3);
        }
        // A dual point outside is no proof of what lies below the minimum.
        let outside = certify_lasso(&problem, 1.0, &[(0, 1.5)], &[2.0, 1.0]);
        assert!(outside.dual <= 3.625 && outside.gap >= 0.0);
    }

    /// The bound is that of the best multiple of λ that is inside, for λ of any length.
    #[test]
    fn the_dual_point_is_scaled_to_its_best() {
        let phi = Dense::new(2, vec![2.0, 0.0, 0.0, 1.0]);
        let target = [4.0, 0.5];
        let problem = Problem {
            dictionary: &phi,
            target: &target,
            tolerance: 0.0,
        };
        for (penalty, dual) in [
            (2.0, [0.3, 0.1]),
            (9.0, [0.3, 0.1]),
            (9.0, [0.6, -0.8]),
            (0.5, [0.2, 3.0]),
        ] {
            let largest = f64::max(f64::abs(dual[0]), f64::abs(dual[1]));
            let inside = 1.0 / largest.max(1.0);
            let value = |s: f64| {
                let lambda = dual.map(|d| s * d);
                dot(&target, &lambda) - 0.5 * penalty * norm(&lambda).powi(2)
            };
            let all = (0..=10_000).map(|k| value(inside * f64::from(k) * 1e-4));
            let best = all.fold(f64::NEG_INFINITY, f64::max);
            let found = certify_lasso(&problem, penalty, &[], &dual).dual;
            assert!(
                (found - best).abs() < 1e-6 && found <= 4.0 + 0.5,
                "{penalty}: {found} {best}"
            );
        }
    }

    #[test]
    fn at_zero_it_is_basis_pursuit() {
        let phi = Dense::new(1, vec![2.0]);
        let problem = Problem {
            dictionary: &phi,
            target: &[4.0],
            tolerance: 0.0,
        };
        assert_eq!(certify_lasso(&problem, 0.0, &[(0, 2.0)], &[1.0]).gap, 0.0);
        let misfit = certify_lasso(&problem, 0.0, &[(0, 1.9)], &[1.0]);
        assert_eq!(misfit.gap, f64::INFINITY);
    }
}
