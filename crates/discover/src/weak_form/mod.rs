//! The weak form of an equation: integrals against test functions, so that no noisy signal is differentiated.
//!
//! In: a model, its dataset as measured, the library of one equation. Out: [`Weak`], from it [`Whitened`] regression problems whose rows
//! have independent errors of size one. Chooses no terms and sees no solver.
//!
//! For d^p x/dt^p = Σ a φ and a test function ψ, (−1)^p ∫ψ⁽ᵖ⁾ x dt = Σ a ∫ψ φ dt (Messenger & Bortz 2021, WSINDy).
//!
//! 1. The left side is an exact combination of samples (`test_functions`).
//! 2. The right side is integrated by quadrature (`quadrature`) along a first guess of the motion: records smoothed
//!    (`whittaker_smoother`) and interpolated between samples (`interpolation`), held inputs held. Terms with high derivatives are first
//!    integrated by parts (`integration_by_parts`).
//! 3. What noise does to either side is known to first order: to the left always, to the right given a guess of the equation
//!    (`noise_propagation`). Rows are whitened by the covariance of both (Bortz, Messenger & Dukic 2023, WENDy), and by the same
//!    derivatives the guess of the motion is corrected towards the readings, which removes the smoother's bias to first order.

mod banded_cholesky;
mod integration_by_parts;
mod interpolation;
mod noise_propagation;
mod quadrature;
mod segments;
mod signal_sources;
mod test_functions;
mod thresholds;
mod weak_equation;
mod whittaker_smoother;

pub use thresholds::tables;
pub use weak_equation::{Motion, Place, Weak, WeakFormInputs, Whitened};
