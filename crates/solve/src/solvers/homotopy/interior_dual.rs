//! A dual point in the interior of the optimal face.
//!
//! In: the end of a path for exact data, and its working set. Out: λ with the same φᵀλ = ±1 on the support and smaller correlations
//! off it. A path ends on bounds of columns off the support too, and there the dual point cannot prove that the answer is unique.
//! It proves nothing by itself; the certificate does.

use super::path::PathPoint;
use super::updated_qr::UpdatedQr;
use super::working_set::WorkingSet;
use crate::simd::axpy;
use crate::thresholds::HOMOTOPY;

/// λ moved into the interior of the optimal face. It moves along the direction of least norm that leaves all bounds off the support
/// at the same rate, to where the largest correlation of the working set off the support is least. If `feasible` rejects that point
/// because of columns outside the working set, the step is halved until it is feasible, and then once more. `None` if λ is on no
/// bound off the support, or cannot leave them.
pub(super) fn interior_dual(
    set: &WorkingSet,
    point: &PathPoint,
    feasible: &dyn Fn(&[f64]) -> bool,
) -> Option<Vec<f64>> {
    let largest = point
        .coefficients
        .iter()
        .fold(0.0_f64, |m, (_, a)| m.max(a.abs()));
    let mut qr = UpdatedQr::new(point.lambda.len());
    let mut slopes = Vec::new();
    let mut on_support = vec![false; set.len()];
    for (k, a) in &point.coefficients {
        if a.abs() > HOMOTOPY.support * largest && qr.push(set.column(*k)) {
            on_support[*k] = true;
            slopes.push(0.0);
        }
    }
    let c = set.correlations(&point.lambda);
    for k in (0..set.len()).filter(|&k| !on_support[k]) {
        if c[k].abs() > 1.0 - HOMOTOPY.on_bound && qr.push(set.column(k)) {
            slopes.push(-c[k].signum());
        }
    }
    if slopes.iter().all(|a| *a == 0.0) {
        return None;
    }
    let direction = qr.combine(&qr.solve_transposed(&slopes));
    let g = set.correlations(&direction);
    let largest_off_support = |step: f64| {
        let off = (0..set.len()).filter(|&k| !on_support[k]);
        off.fold(0.0_f64, |m, k| m.max((c[k] + step * g[k]).abs()))
    };
    let step = minimise(&largest_off_support);
    let moved = |step: f64| {
        let mut lambda = point.lambda.clone();
        axpy(step, &direction, &mut lambda);
        lambda
    };
    let whole = (step > 0.0).then(|| moved(step))?;
    if feasible(&whole) {
        return Some(whole);
    }
    // Half of a feasible step is in the interior, since correlations are linear in the step and λ itself is feasible.
    let shorter = (1..=HOMOTOPY.shorter_steps).map(|k| step * 0.5_f64.powi(k));
    let mut shorter = shorter.map(|step| (step, moved(step)));
    let (step, _) = shorter.find(|(_, lambda)| feasible(lambda))?;
    Some(moved(0.5 * step))
}

/// The minimiser of a convex function on [0, 1], by ternary search.
fn minimise(f: &impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HOMOTOPY.line_search {
        let third = (high - low) / 3.0;
        if f(low + third) <= f(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    0.5 * (low + high)
}
