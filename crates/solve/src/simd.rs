//! Loops compiled a second time for the widest registers of the machine, and the two loops that most others are made of.
//!
//! In: a loop over contiguous numbers. Out: the same result to the last bit: products and sums are never fused or reordered.
//! Only what is inlined into the loop gains.

use multiversion::multiversion;

/// Runs `f` compiled for the instructions that this machine has.
#[inline(always)]
pub fn wide<R>(f: impl FnOnce() -> R) -> R {
    dispatched(f)
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+fma+lzcnt+popcnt"))]
fn dispatched<R>(f: impl FnOnce() -> R) -> R {
    f()
}

/// y += a x
#[inline(always)]
pub fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}

/// aᵀb, summed in order.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
