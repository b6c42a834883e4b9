//! The widest instructions that the machine has, and the loops that everything here is made of.
//!
//! In: a loop over numbers that lie beside each other. Out: what it does anyway, to the last bit: products and sums are never fused
//! or reordered. What is called in it must be inlined to gain.

use multiversion::multiversion;

/// Runs `f` compiled for what this machine has.
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
