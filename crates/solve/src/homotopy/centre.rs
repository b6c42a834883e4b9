//! A dual point off the bounds that the answer does not need.
//!
//! In: the end of a path for exact data, and its working set. Out: λ with the same φᵀλ = ±1 on the support, and smaller
//! correlations elsewhere: a path ends on the bounds of columns that it passed, and those would leave open whether the answer
//! is unique. It proves nothing by itself; the certificate does.

use super::super::pool::Pool;
use super::super::reduce::add_scaled;
use super::factor::Factor;
use super::path::Place;

/// Part of the largest coefficient under which a column is not of the support.
const SUPPORT: f64 = 1e-9;
/// Distance from a bound that counts as on it.
const TIGHT: f64 = 1e-3;
/// Halvings of the interval of the line search.
const HALVINGS: usize = 30;

/// λ, moved along the least-norm direction that leaves all bounds off the support at the same speed, as far as the largest
/// correlation in the pool falls. `None` if no bound is met off the support, or none can be left.
pub(super) fn centre(pool: &Pool, place: &Place) -> Option<Vec<f64>> {
    let largest = place
        .coefficients
        .iter()
        .fold(0.0_f64, |m, (_, a)| m.max(a.abs()));
    let mut factor = Factor::new(place.lambda.len());
    let mut aims = Vec::new();
    let mut on_support = vec![false; pool.len()];
    for (k, a) in &place.coefficients {
        if a.abs() > SUPPORT * largest && factor.push(pool.column(*k)) {
            on_support[*k] = true;
            aims.push(0.0);
        }
    }
    let c = pool.correlations(&place.lambda);
    for k in (0..pool.len()).filter(|&k| !on_support[k]) {
        if c[k].abs() > 1.0 - TIGHT && factor.push(pool.column(k)) {
            aims.push(-c[k].signum());
        }
    }
    if aims.iter().all(|a| *a == 0.0) {
        return None;
    }
    let direction = factor.combine(&factor.solve_transposed(&aims));
    let g = pool.correlations(&direction);
    let worst = |step: f64| {
        let off = (0..pool.len()).filter(|&k| !on_support[k]);
        off.fold(0.0_f64, |m, k| m.max((c[k] + step * g[k]).abs()))
    };
    let step = least(&worst);
    let mut lambda = place.lambda.clone();
    add_scaled(&mut lambda, step, &direction);
    (step > 0.0).then_some(lambda)
}

/// Where a convex function is least on [0, 1], by thirds.
fn least(f: &impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let third = (high - low) / 3.0;
        if f(low + third) <= f(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    0.5 * (low + high)
}
