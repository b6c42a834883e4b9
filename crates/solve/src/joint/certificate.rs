//! What a dual point proves about coefficients of a joint problem: computed from the problem alone, no solver is trusted.
//!
//! For any λ_e and ν (ν ≤ 0 on inequalities) with |φ_jᵀλ_e + Σ_k ν_k c_kj| ≤ ‖φ_j‖/‖y_e‖ for all columns, whatever fits and
//! obeys the rows has Σ‖D a‖₁/‖y‖ ≥ Σ(yᵀλ − ε‖λ‖₂) + νᵀd (weak duality; Boyd & Vandenberghe, section 5.2). It alters nothing.

use super::super::certificate::{FEASIBLE, OPTIMAL_GAP};
use super::super::reduce::{dot, nonzero, norm};
use super::{Joint, Row, Sense, named};

/// What can be said about coefficients and a dual point of a joint problem.
#[derive(Clone, Debug, PartialEq)]
pub struct JointProof {
    /// Σ ‖D a‖₁/‖y‖ over the blocks.
    pub primal: f64,
    /// The bound of the dual point, scaled into feasibility.
    pub dual: f64,
    /// (primal − dual)/primal
    pub gap: f64,
    /// Largest price of a column, of the dual point as given; 1 on the support of an optimal answer.
    pub largest_price: f64,
    /// For each block 1 − the largest price of a column off its support, of the scaled dual point.
    pub margins: Vec<f64>,
    /// Every block within its tolerance (to `FEASIBLE`), every row to rounding.
    pub feasible: bool,
    /// Feasible, and |gap| ≤ `OPTIMAL_GAP`.
    pub proves_optimal: bool,
}

/// Checks coefficients (each block by rising column, raw units) against duals (length M each) and one multiplier a row.
pub fn certify_joint(
    joint: &Joint,
    coefficients: &[Vec<(usize, f64)>],
    duals: &[Vec<f64>],
    multipliers: &[f64],
) -> JointProof {
    let mut primal = 0.0;
    let mut feasible = joint.rows.iter().all(|r| holds(r, coefficients));
    for (problem, a) in joint.blocks.iter().zip(coefficients) {
        let length = norm(problem.target);
        primal += problem.shares(a).sum::<f64>() / nonzero(length);
        let exact = problem.tolerance == 0.0;
        let allowed = if exact { length } else { problem.tolerance };
        let allowed = problem.tolerance + FEASIBLE * allowed;
        feasible &= norm(&problem.left(a)) <= allowed;
    }
    let signed: Vec<f64> = joint.rows.iter().zip(multipliers).map(sign).collect();
    let prices = joint.blocks.iter().zip(duals).zip(coefficients).enumerate();
    let prices: Vec<(f64, f64)> = prices
        .map(|(e, ((_, lambda), a))| prices_of(joint, e, lambda, &signed, a))
        .collect();
    let largest_price = prices.iter().map(|(all, _)| *all).fold(0.0, f64::max);
    let scale = largest_price.max(1.0);
    let mut dual: f64 = joint
        .rows
        .iter()
        .zip(&signed)
        .map(|(r, m)| m * r.right)
        .sum();
    for (problem, lambda) in joint.blocks.iter().zip(duals) {
        dual += dot(problem.target, lambda) - problem.tolerance * norm(lambda);
    }
    dual /= scale;
    let gap = (primal - dual) / nonzero(primal.max(dual));
    JointProof {
        primal,
        dual,
        gap,
        largest_price,
        margins: prices.iter().map(|(_, off)| 1.0 - off / scale).collect(),
        feasible,
        proves_optimal: feasible && gap.abs() <= OPTIMAL_GAP,
    }
}

/// A multiplier of the wrong sign proves nothing.
fn sign((row, multiplier): (&Row, &f64)) -> f64 {
    match row.sense {
        Sense::Equal => *multiplier,
        Sense::AtMost | Sense::Below => multiplier.min(0.0),
    }
}

fn holds(row: &Row, coefficients: &[Vec<(usize, f64)>]) -> bool {
    let (mut sum, mut largest) = (-row.right, row.right.abs());
    for (block, column, weight) in &row.entries {
        let a = coefficients.get(*block).map_or(&[][..], |a| a.as_slice());
        let at = a.binary_search_by_key(column, |(j, _)| *j);
        let value = at.ok().and_then(|k| a.get(k)).map_or(0.0, |(_, a)| *a);
        sum += weight * value;
        largest = largest.max((weight * value).abs());
    }
    match row.sense {
        Sense::Equal => sum.abs() <= FEASIBLE * largest,
        Sense::AtMost | Sense::Below => sum <= FEASIBLE * largest,
    }
}

/// max_j |φ_jᵀλ + Σ_k ν_k c_kj| ‖y‖/‖φ_j‖ over all columns of a block, and over those without a coefficient.
fn prices_of(
    joint: &Joint,
    e: usize,
    lambda: &[f64],
    multipliers: &[f64],
    coefficients: &[(usize, f64)],
) -> (f64, f64) {
    let problem = &joint.blocks[e];
    let size = norm(problem.target);
    let mut tied = named(joint, e);
    tied.sort_unstable();
    tied.dedup();
    let mut prices: Vec<(usize, f64)> = Vec::new();
    // So many that the strongest which is neither tied nor on the support is among them.
    let most = tied.len() + coefficients.len() + 1;
    let strongest = problem.dictionary.strongest(lambda, most, 0.0).columns;
    let plain = strongest.into_iter();
    let plain = plain.filter(|(j, _)| tied.binary_search(j).is_err());
    prices.extend(plain.map(|(j, c)| (j, c.abs() * size)));
    let mut column = vec![0.0; lambda.len()];
    for j in tied {
        problem.dictionary.column(j, &mut column);
        let rows = joint.rows.iter().zip(multipliers);
        let pull: f64 = rows
            .flat_map(|(r, m)| r.entries.iter().map(move |(b, c, w)| (*b, *c, m * w)))
            .filter(|(b, c, _)| *b == e && *c == j)
            .map(|(_, _, p)| p)
            .sum();
        let length = problem.dictionary.norms()[j];
        let price = (dot(&column, lambda) + pull).abs() * size;
        // A column of zeros costs nothing, so nothing may pull at it.
        let price = match (length > 0.0, price > 0.0) {
            (true, _) => price / length,
            (false, true) => f64::INFINITY,
            (false, false) => 0.0,
        };
        prices.push((j, price));
    }
    let used = |j: &usize| coefficients.binary_search_by_key(j, |(k, _)| *k).is_ok();
    let off = prices.iter().filter(|(j, _)| !used(j));
    (
        prices.iter().map(|(_, p)| *p).fold(0.0, f64::max),
        off.map(|(_, p)| *p).fold(0.0, f64::max),
    )
}
