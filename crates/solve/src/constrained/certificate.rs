//! The optimality certificate of constrained basis pursuit, computed from the problem alone: no solver is trusted.
//!
//! For any λ_e and ν (ν ≤ 0 on inequalities) with |φ_jᵀλ_e + Σ_k ν_k c_kj| ≤ ‖φ_j‖/‖y_e‖ for all columns, every a that is
//! feasible has Σ‖D a‖₁/‖y‖ ≥ Σ(yᵀλ − ε‖λ‖₂) + νᵀd (weak duality; Boyd & Vandenberghe, section 5.2). It alters nothing.

use super::problem::{ConstrainedProblem, LinearConstraint, Sense};
use crate::linalg::{nonzero, norm};
use crate::simd::dot;
use crate::thresholds::CERTIFICATES;

/// What can be said about coefficients and a dual point of a constrained problem.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstrainedCertificate {
    /// Σ ‖D a‖₁/‖y‖ over the blocks.
    pub primal: f64,
    /// The bound of the dual point, scaled into feasibility.
    pub dual: f64,
    /// (primal − dual)/primal
    pub gap: f64,
    /// Largest correlation of a column, constraints included, of the dual point as given; 1 on the support of an optimal answer.
    pub largest_correlation: f64,
    /// For each block 1 − the largest correlation of a column off its support, of the scaled dual point.
    pub margins: Vec<f64>,
    /// Every block within its tolerance, every constraint satisfied, as far as rounding allows.
    pub feasible: bool,
    /// Feasible, and the gap closed.
    pub proves_optimal: bool,
}

/// Checks coefficients (each block by rising column, raw units) against duals (length M each) and one multiplier a row.
pub fn certify_constrained(
    constrained: &ConstrainedProblem,
    coefficients: &[Vec<(usize, f64)>],
    duals: &[Vec<f64>],
    multipliers: &[f64],
) -> ConstrainedCertificate {
    let mut primal = 0.0;
    let mut feasible = constrained.rows.iter().all(|r| satisfied(r, coefficients));
    for (problem, a) in constrained.blocks.iter().zip(coefficients) {
        let length = norm(problem.target);
        primal += problem.contributions(a).sum::<f64>() / nonzero(length);
        let exact = problem.tolerance == 0.0;
        let allowed = if exact { length } else { problem.tolerance };
        let allowed = problem.tolerance + CERTIFICATES.feasible * allowed;
        feasible &= norm(&problem.residual(a)) <= allowed;
    }
    let multipliers: Vec<f64> = constrained
        .rows
        .iter()
        .zip(multipliers)
        .map(feasible_multiplier)
        .collect();
    let correlations = constrained
        .blocks
        .iter()
        .zip(duals)
        .zip(coefficients)
        .enumerate();
    let correlations: Vec<(f64, f64)> = correlations
        .map(|(e, ((_, lambda), a))| correlations_of(constrained, e, lambda, &multipliers, a))
        .collect();
    let largest_correlation = correlations.iter().map(|(all, _)| *all).fold(0.0, f64::max);
    let scale = largest_correlation.max(1.0);
    let mut dual: f64 = constrained
        .rows
        .iter()
        .zip(&multipliers)
        .map(|(r, m)| m * r.right)
        .sum();
    for (problem, lambda) in constrained.blocks.iter().zip(duals) {
        dual += dot(problem.target, lambda) - problem.tolerance * norm(lambda);
    }
    dual /= scale;
    let gap = (primal - dual) / nonzero(primal.max(dual));
    ConstrainedCertificate {
        primal,
        dual,
        gap,
        largest_correlation,
        margins: correlations
            .iter()
            .map(|(_, off)| 1.0 - off / scale)
            .collect(),
        feasible,
        proves_optimal: feasible && gap.abs() <= CERTIFICATES.optimal_gap,
    }
}

/// A multiplier; zero where its sign is infeasible.
fn feasible_multiplier((row, multiplier): (&LinearConstraint, &f64)) -> f64 {
    match row.sense {
        Sense::Equal => *multiplier,
        Sense::AtMost | Sense::Below => multiplier.min(0.0),
    }
}

fn satisfied(row: &LinearConstraint, coefficients: &[Vec<(usize, f64)>]) -> bool {
    let (mut sum, mut largest) = (-row.right, row.right.abs());
    for (block, column, weight) in &row.entries {
        let a = coefficients.get(*block).map_or(&[][..], |a| a.as_slice());
        let at = a.binary_search_by_key(column, |(j, _)| *j);
        let value = at.ok().and_then(|k| a.get(k)).map_or(0.0, |(_, a)| *a);
        sum += weight * value;
        largest = largest.max((weight * value).abs());
    }
    match row.sense {
        Sense::Equal => sum.abs() <= CERTIFICATES.feasible * largest,
        Sense::AtMost | Sense::Below => sum <= CERTIFICATES.feasible * largest,
    }
}

/// max_j |φ_jᵀλ + Σ_k ν_k c_kj| ‖y‖/‖φ_j‖ over all columns of a block, and over those off the support.
fn correlations_of(
    constrained: &ConstrainedProblem,
    e: usize,
    lambda: &[f64],
    multipliers: &[f64],
    coefficients: &[(usize, f64)],
) -> (f64, f64) {
    let problem = &constrained.blocks[e];
    let target_norm = norm(problem.target);
    let mut constrained_columns = constrained.named_columns(e);
    constrained_columns.sort_unstable();
    constrained_columns.dedup();
    let mut correlations: Vec<(usize, f64)> = Vec::new();
    // As many as to include the largest that is neither constrained nor on the support.
    let most = constrained_columns.len() + coefficients.len() + 1;
    let priced = problem.dictionary.price(lambda, most, 0.0).columns;
    let free = priced.into_iter();
    let free = free.filter(|(j, _)| constrained_columns.binary_search(j).is_err());
    correlations.extend(free.map(|(j, c)| (j, c.abs() * target_norm)));
    let mut column = vec![0.0; lambda.len()];
    for j in constrained_columns {
        problem.dictionary.column(j, &mut column);
        let rows = constrained.rows.iter().zip(multipliers);
        let multiplier_part: f64 = rows
            .flat_map(|(r, m)| r.entries.iter().map(move |(b, c, w)| (*b, *c, m * w)))
            .filter(|(b, c, _)| *b == e && *c == j)
            .map(|(_, _, p)| p)
            .sum();
        let length = problem.dictionary.norm(j);
        let correlation = (dot(&column, lambda) + multiplier_part).abs() * target_norm;
        // A column of zeros costs nothing, so its multipliers must cancel.
        let correlation = match (length > 0.0, correlation > 0.0) {
            (true, _) => correlation / length,
            (false, true) => f64::INFINITY,
            (false, false) => 0.0,
        };
        correlations.push((j, correlation));
    }
    let used = |j: &usize| coefficients.binary_search_by_key(j, |(k, _)| *k).is_ok();
    let off = correlations.iter().filter(|(j, _)| !used(j));
    (
        correlations.iter().map(|(_, p)| *p).fold(0.0, f64::max),
        off.map(|(_, p)| *p).fold(0.0, f64::max),
    )
}
