//! The widest instructions that the machine has.
//!
//! In: a loop over numbers that lie beside each other. Out: what it does anyway, to the last bit: products and sums are never fused
//! or reordered. What is called in it must be inlined to gain.

use faer::traits::pulp::Arch;

/// Runs `f` compiled for what this machine has.
#[inline(always)]
pub(super) fn wide<R>(f: impl FnOnce() -> R) -> R {
    Arch::new().dispatch(f)
}
