//! The normal equations of one equation that was found from rows, block by block of the rows.
//!
//! In: the equation's columns on its rows. Out: [`BlockNormalEquations`] of the terms found and of the columns most likely to replace one.

use std::ops::Range;

use super::target_regression::sum_blocks;
use super::thresholds::ROW_BLOCKS;
use crate::scaled_design::{OrthonormalBasis, ScaledDesign};
use sidc_solve::simd::dot;
use sidc_system::discovery::BlockNormalEquations;

/// A single block if the residuals of the equation are not those of the rows. `None` if a trajectory was fitted, since that fit
/// has blocks of its own, or if coefficients obey constraints, which single changes of terms would violate.
pub fn block_normal_equations(design: &ScaledDesign) -> Option<BlockNormalEquations> {
    let evidence = design.evidence;
    let otherwise = evidence.joint.is_some() || evidence.certificate.constrained;
    if otherwise || design.support.is_empty() {
        return None;
    }
    let candidates = candidates(design);
    let rows = design.rows();
    let observed = evidence.origin.is_samples();
    let count = match observed {
        true => ROW_BLOCKS.blocks.min(rows / ROW_BLOCKS.min_rows).max(1),
        false => 1,
    };
    let square = dot(&design.target, &design.target) / rows as f64;
    let left = design.residual_square(&design.support) / rows as f64;
    let variance = left
        .max(design.noise.floor)
        .max(ROW_BLOCKS.rounding * square);
    let scale = design.noise.rows / rows as f64 / variance.max(f64::MIN_POSITIVE);
    let mut columns: Vec<&[f64]> = candidates.iter().map(|p| design.unit(*p)).collect();
    columns.push(&design.target);
    let edge = |i: usize| i * rows / count;
    let block = |i: usize| products(&columns, edge(i)..edge(i + 1), scale);
    let products: Vec<Vec<f64>> = (0..count).map(block).collect();
    let price = |n: f64| n.max(2.0).ln() + 2.0 * (design.candidates.max(1) as f64).ln();
    Some(BlockNormalEquations {
        columns: (candidates.iter())
            .map(|p| (design.equation.target, design.term(*p).clone()))
            .collect(),
        whole: sum_blocks(products.iter(), columns.len()),
        products,
        support: (design.support.iter())
            .filter_map(|p| candidates.binary_search(p).ok())
            .collect(),
        readings: design.noise.rows,
        price: (price(design.noise.rows), price(0.5 * design.noise.rows)),
    })
}

/// The support, the columns most correlated with the part of each term that the other terms do not explain, and those most
/// correlated with the residual.
fn candidates(design: &ScaledDesign) -> Vec<usize> {
    let all = || design.support.iter();
    let mut directions: Vec<Vec<f64>> = all()
        .map(|p| {
            let others = all().filter(|q| *q != p).map(|q| design.unit(*q));
            OrthonormalBasis::of(others).residual(design.unit(*p))
        })
        .collect();
    let support = OrthonormalBasis::of(all().map(|p| design.unit(*p)));
    directions.push(support.residual(&design.target));
    let each = ROW_BLOCKS.alternatives.div_ceil(directions.len());
    let mut candidates = design.support.clone();
    for direction in directions {
        let correlation = |p: usize| (p, dot(design.unit(p), &direction).abs());
        let mut ranked: Vec<(usize, f64)> = (0..design.columns.len()).map(correlation).collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let new = ranked
            .iter()
            .map(|(p, _)| *p)
            .filter(|p| !candidates.contains(p));
        let new: Vec<usize> = new.take(each).collect();
        candidates.extend(new);
    }
    candidates.sort_unstable();
    candidates
}

/// The scaled Gram matrix of all columns over some rows, by rows.
fn products(columns: &[&[f64]], rows: Range<usize>, scale: f64) -> Vec<f64> {
    let w = columns.len();
    let mut out = vec![0.0; w * w];
    for (i, a) in columns.iter().enumerate() {
        for (j, b) in columns.iter().enumerate().take(i + 1) {
            let product = scale * dot(&a[rows.clone()], &b[rows.clone()]);
            out[i * w + j] = product;
            out[j * w + i] = product;
        }
    }
    out
}
