//! One reflection I − τ v vᵀ, v₀ = 1, that leaves of a vector its first entry alone (Golub & Van Loan, section 5.1).

use super::dot;
use crate::lanes::axpy;

/// Sums of squares outside of this range may have lost digits to underflow, or overflowed.
const SAFE: std::ops::RangeInclusive<f64> = 1e-280..=1e280;

/// Turns x into (β, v₁, v₂, …), β the first entry that is left of it; returns τ, zero where there is nothing to reflect.
#[inline(always)]
pub(super) fn reflector(x: &mut [f64]) -> f64 {
    let Some((head, tail)) = x.split_first_mut() else {
        return 0.0;
    };
    let below = length(tail);
    if below == 0.0 {
        return 0.0;
    }
    let beta = -head.hypot(below).copysign(*head);
    let first = *head - beta;
    tail.iter_mut().for_each(|v| *v /= first);
    let tau = -first / beta;
    *head = beta;
    tau
}

/// (I − τ v vᵀ) y; the first entry of `v` is not read, it stands for one.
#[inline(always)]
pub(super) fn reflect(v: &[f64], tau: f64, y: &mut [f64]) {
    let (Some((_, v)), Some((head, tail))) = (v.split_first(), y.split_first_mut()) else {
        return;
    };
    let along = tau * (*head + dot(v, tail));
    *head -= along;
    axpy(-along, v, tail);
}

/// ‖x‖₂ without overflow.
#[inline(always)]
pub(super) fn length(x: &[f64]) -> f64 {
    let squares = dot(x, x);
    if squares == 0.0 && x.iter().all(|x| *x == 0.0) || SAFE.contains(&squares) {
        return squares.sqrt();
    }
    let largest = x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    largest * x.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt()
}
