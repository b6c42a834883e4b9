//! The optimality certificate of basis pursuit.
//!
//! Weak duality: for any λ with |φ_jᵀλ| ≤ w_j every feasible a has ‖Da‖₁ ≥ yᵀλ − ε‖λ‖₂ (Boyd & Vandenberghe, section 5.2).
//! Any λ is scaled into that set; the gap that remains is the proof. It never alters coefficients.

use crate::dictionary::unit_columns;
use crate::linalg::{
    RankRevealingQr, condition_number, difference, nonzero, norm, times_transposed,
};
use crate::problem::Problem;
use crate::simd::{axpy, dot};
use crate::thresholds::CERTIFICATES;

/// What can be said about a pair (a, λ) on the original problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// ‖Da‖₁
    pub primal: f64,
    /// yᵀλ − ε‖λ‖₂ after scaling λ into feasibility: a lower bound on the minimum.
    pub dual: f64,
    /// (primal − dual)/primal; negative only as far as a is infeasible.
    pub gap: f64,
    /// ‖Φa − y‖₂ in the units of y.
    pub residual: f64,
    /// The same relative to ‖y‖.
    pub relative_residual: f64,
    /// max |φ_jᵀλ|/w_j over all columns, of λ as given.
    pub largest_correlation: f64,
    /// 1 − max |φ_jᵀλ|/w_j over the columns off the support, of the scaled λ.
    pub margin: f64,
    /// gap/margin: bound on the part of its 1-norm that any other minimiser can have off the support.
    pub off_support: f64,
    /// Column indices, ascending.
    pub support: Vec<usize>,
    /// Numerical rank of the support's unit columns.
    pub rank: usize,
    /// Their condition number.
    pub condition: f64,
    /// Feasible, and the gap closed, within `CERTIFICATES`.
    pub proves_optimal: bool,
    /// Optimal, the support has full rank, and `off_support` is within its bound.
    pub proves_unique: bool,
}

/// Checks `coefficients` (column, value in raw units; zeros left out) and `dual` (length M) against the problem, on the support of [`support`].
pub fn certify(problem: &Problem, coefficients: &[(usize, f64)], dual: &[f64]) -> Certificate {
    let support = support(problem, coefficients);
    certify_support(problem, coefficients, dual, support)
}

/// The columns whose |a_j|‖φ_j‖ is not negligible beside the largest.
pub fn support(problem: &Problem, coefficients: &[(usize, f64)]) -> Vec<usize> {
    let largest = problem.contributions(coefficients).fold(0.0_f64, f64::max);
    let columns = coefficients.iter().map(|(j, _)| *j);
    columns
        .zip(problem.contributions(coefficients))
        .filter(|(_, contribution)| *contribution > CERTIFICATES.support * largest)
        .map(|(j, _)| j)
        .collect()
}

/// The same on a given support (ascending indices).
pub fn certify_support(
    problem: &Problem,
    coefficients: &[(usize, f64)],
    dual: &[f64],
    support: Vec<usize>,
) -> Certificate {
    let primal: f64 = problem.contributions(coefficients).sum();
    // One column more than the support has, so that the largest correlation off the support is among them.
    let priced = problem.dictionary.price(dual, support.len() + 1, 0.0);
    let largest_correlation = priced.largest();
    let scale = largest_correlation.max(1.0);
    let dual = dual_value(problem, dual) / scale;
    let off = priced.columns.iter();
    let off = off.filter(|(j, _)| support.binary_search(j).is_err());
    let margin = 1.0 - off.map(|(_, c)| c.abs()).next().unwrap_or(0.0) / scale;
    let gap = (primal - dual) / nonzero(primal.max(dual));
    let residual = norm(&problem.residual(coefficients));
    let length = norm(problem.target);
    let (rank, condition) = rank_and_condition(problem, &support);
    let allowed = if problem.tolerance > 0.0 {
        problem.tolerance * (1.0 + CERTIFICATES.feasible)
    } else {
        CERTIFICATES.feasible * length
    };
    let rounding = CERTIFICATES.consistent * length;
    let proves_optimal = residual
        <= allowed.max(problem.tolerance + rounding * CERTIFICATES.feasible)
        && gap.abs() <= CERTIFICATES.optimal_gap;
    let off_support = if margin > 0.0 {
        gap.max(0.0) / margin
    } else {
        f64::INFINITY
    };
    Certificate {
        primal,
        dual,
        gap,
        residual,
        relative_residual: residual / nonzero(length),
        largest_correlation,
        margin,
        off_support,
        rank,
        condition,
        proves_optimal,
        proves_unique: proves_optimal
            && rank == support.len()
            && off_support <= CERTIFICATES.off_support,
        support,
    }
}

/// λ plus the least-norm correction after which φ_jᵀλ = sign_j w_j on the support, where that gives a larger lower bound than λ.
/// `signs` (±1) goes with `support`. With ε > 0 the given λ is usually kept.
pub fn refine_dual(problem: &Problem, support: &[usize], signs: &[f64], dual: &[f64]) -> Vec<f64> {
    let weight = |j: &usize| nonzero(problem.dictionary.weight(*j));
    let weights: Vec<f64> = support.iter().map(weight).collect();
    let unit = unit_columns(problem.dictionary, support, &weights);
    let Some(qr) = RankRevealingQr::new(&unit) else {
        return dual.to_vec();
    };
    let mut refined = dual.to_vec();
    for _ in 0..2 {
        let defect = difference(signs, &times_transposed(&unit, &refined));
        axpy(1.0, &qr.least_norm(&defect), &mut refined);
    }
    let bound = |lambda: &[f64]| {
        let largest = problem.dictionary.price(lambda, 1, 0.0).largest();
        dual_value(problem, lambda) / largest.max(1.0)
    };
    if bound(&refined) > bound(dual) {
        refined
    } else {
        dual.to_vec()
    }
}

/// yᵀλ − ε‖λ‖₂
fn dual_value(problem: &Problem, lambda: &[f64]) -> f64 {
    dot(problem.target, lambda) - problem.tolerance * norm(lambda)
}

fn rank_and_condition(problem: &Problem, support: &[usize]) -> (usize, f64) {
    let length = |j: &usize| nonzero(problem.dictionary.norm(*j));
    let lengths: Vec<f64> = support.iter().map(length).collect();
    let unit = unit_columns(problem.dictionary, support, &lengths);
    let rank = RankRevealingQr::new(&unit).map_or(0, |p| p.rank);
    (rank, condition_number(&unit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dictionary::Dense;

    fn problem<'a>(phi: &'a Dense, y: &'a [f64], tolerance: f64) -> Problem<'a> {
        Problem {
            dictionary: phi,
            target: y,
            tolerance,
        }
    }

    #[test]
    fn one_column_is_optimal_and_unique() {
        let phi = Dense::new(1, vec![2.0, 1.0]);
        // Both unit columns are 1: any split is optimal, so nothing is unique.
        let c = certify(&problem(&phi, &[4.0], 0.0), &[(0, 2.0)], &[1.0]);
        assert!(c.proves_optimal && !c.proves_unique);
        assert_eq!((c.primal, c.dual, c.support.len()), (4.0, 4.0, 1));
        let phi = Dense::new(2, vec![2.0, 0.0, 0.0, 1.0]);
        let c = certify(&problem(&phi, &[4.0, 0.0], 0.0), &[(0, 2.0)], &[1.0, 0.25]);
        assert!(c.proves_optimal && c.proves_unique);
        assert_eq!((c.margin, c.rank, c.condition), (0.75, 1, 1.0));
    }

    #[test]
    fn wrong_answers_are_not_certified() {
        let phi = Dense::new(2, vec![1.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        let y = [1.0, 1.0];
        // (1, 1, 0) is feasible with norm 2; the minimum is √2 on the third column.
        let split = certify(&problem(&phi, &y, 0.0), &[(0, 1.0), (1, 1.0)], &[1.0, 1.0]);
        assert!(!split.proves_optimal);
        let infeasible = certify(&problem(&phi, &y, 0.0), &[(2, 0.9)], &[0.7, 0.7]);
        assert!(!infeasible.proves_optimal);
        let right = certify(
            &problem(&phi, &y, 0.0),
            &[(2, 1.0)],
            &[0.5_f64.sqrt(), 0.5_f64.sqrt()],
        );
        assert!(right.proves_optimal && right.proves_unique);
    }

    #[test]
    fn refining_reaches_the_vertex() {
        let phi = Dense::new(2, vec![1.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        let y = [1.0, 1.0];
        let p = problem(&phi, &y, 0.0);
        let rough = [0.7, 0.7];
        let fine = refine_dual(&p, &[2], &[1.0], &rough);
        let (before, after) = (
            certify(&p, &[(2, 1.0)], &rough),
            certify(&p, &[(2, 1.0)], &fine),
        );
        assert!(before.gap > 1e-3 && after.gap.abs() < 1e-15);
    }

    #[test]
    fn zero_is_certified_for_a_target_within_tolerance() {
        let phi = Dense::new(1, vec![1.0]);
        let c = certify(&problem(&phi, &[0.5], 1.0), &[], &[0.0]);
        assert!(c.proves_optimal && c.support.is_empty());
    }

    /// ε and the gap, each by itself: a = y − ε is the least that is within ε of y.
    #[test]
    fn a_millionth_is_the_bound_for_residual_and_gap() {
        let phi = Dense::new(2, vec![1.0, 0.0, 0.6, 0.8]);
        let y = [1000.0, 0.0];
        let proves = |tolerance: f64, a: f64, dual: &[f64]| {
            certify(&problem(&phi, &y, tolerance), &[(0, a)], dual).proves_optimal
        };
        let dual = [1.0, 0.0];
        assert!(proves(1.0, 999.0, &dual) && proves(1.0, 999.0 - 9e-7, &dual));
        assert!(!proves(1.0, 999.0 - 1.1e-6, &dual));
        assert!(proves(1.0, 999.0009, &dual) && !proves(1.0, 999.0011, &dual));
        assert!(proves(0.0, 999.9995, &dual) && !proves(0.0, 999.9985, &dual));
        // Where ε is next to nothing, rounding of the target is allowed for.
        assert!(proves(1e-13, 1000.0 - 2e-13, &dual));
    }

    #[test]
    fn a_dual_point_that_is_too_long_is_scaled() {
        let phi = Dense::new(2, vec![2.0, 0.0, 0.6, 0.8]);
        let y = [10.0, 0.0];
        let certificate = certify(&problem(&phi, &y, 1.0), &[(0, 4.5)], &[3.0, 0.0]);
        assert_eq!(certificate.largest_correlation, 3.0);
        assert!((certificate.dual - 9.0).abs() < 1e-14 && certificate.gap.abs() < 1e-15);
        assert!((certificate.margin - 0.4).abs() < 1e-15, "{certificate:?}");
        assert!((certificate.relative_residual - 0.1).abs() < 1e-15);
        // A shorter one proves less, and leaves room elsewhere: gap over margin.
        let loose = certify(&problem(&phi, &y, 1.0), &[(0, 4.5)], &[0.9, 0.0]);
        assert!((loose.gap - 0.1).abs() < 1e-14 && (loose.margin - 0.46).abs() < 1e-14);
        assert!((loose.off_support - 0.1 / 0.46).abs() < 1e-13 && !loose.proves_unique);
    }

    #[test]
    fn terms_below_a_millionth_are_not_the_support() {
        let phi = Dense::new(3, vec![1.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 1.0]);
        let p = problem(&phi, &[1.0, 1.0, 1.0], 0.0);
        let of = |b: f64, c: f64| support(&p, &[(0, -2.0), (1, b), (2, c)]);
        // Shares are of unit columns: the second is four long.
        assert_eq!(of(6e-7, 1.9e-6), [0, 1]);
        assert_eq!(of(4e-7, 2.1e-6), [0, 2]);
        assert_eq!(support(&p, &[]), Vec::<usize>::new());
    }
}
