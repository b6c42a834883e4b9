//! Householder reflections I − τ v vᵀ with v₀ = 1 (Golub & Van Loan, section 5.1): they map a vector to a multiple of (1, 0, 0, …).

use super::vectors::{dot_in_lanes, is_safe};
use crate::simd::axpy;

/// Overwrites x with (β, v₁, v₂, …), β the first entry of the image of x. Returns τ; zero where nothing is to be reflected.
#[inline(always)]
pub(super) fn reflector(x: &mut [f64]) -> f64 {
    let Some((head, tail)) = x.split_first_mut() else {
        return 0.0;
    };
    let below = norm(tail);
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

/// y ← (I − τ v vᵀ) y. The first entry of `v` is not read; it stands for one.
#[inline(always)]
pub(super) fn reflect(v: &[f64], tau: f64, y: &mut [f64]) {
    let (Some((_, v)), Some((head, tail))) = (v.split_first(), y.split_first_mut()) else {
        return;
    };
    let along = tau * (*head + dot_in_lanes::<16, f64>(v, tail));
    *head -= along;
    axpy(-along, v, tail);
}

/// ‖x‖₂ without overflow, fast where the sum of squares is safe.
#[inline(always)]
pub(super) fn norm(x: &[f64]) -> f64 {
    let squares = dot_in_lanes::<16, f64>(x, x);
    if squares == 0.0 && x.iter().all(|x| *x == 0.0) || is_safe(squares) {
        return squares.sqrt();
    }
    let largest = x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    largest * x.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt()
}
