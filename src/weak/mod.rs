//! The weak form of an equation: integrals against test functions, so that no noisy signal is ever differentiated.
//!
//! In: a model, its dataset as measured, the library of one equation. Out: [`Weak`], from it [`Whitened`] regression problems whose
//! rows have independent errors of size one. It never chooses terms, and never sees a solver.
//!
//! For d^p x/dt^p = Σ a φ and a test function ψ, (−1)^p ∫ψ⁽ᵖ⁾ x dt = Σ a ∫ψ φ dt. The left side is an exact combination of
//! samples (`splines`); the right is integrated on a first guess of the motion, between samples, with held inputs held. What
//! noise does to either side is known to first order: to the left always, to the right as soon as there is a guess of the
//! equation. Both go into the covariance by which rows are weighted (as in Bortz, Messenger & Dukic 2023, WENDy), and the guess of the
//! motion is corrected towards the measured values by the same derivatives, so that the smoother's bias drops out.

mod banded;
mod curve;
mod influence;
mod lower;
mod problem;
mod route;
mod smooth;
mod splines;
mod stretch;

pub use problem::{Asked, Motion, Place, Weak, Whitened};
