//! Algebra on the found equations: which are coupled, their solution in symbols, and their linearization.
//!
//! In: the `Form` of a discovery. Out: expressions and matrices of numbers, by signals. Prints nothing.

mod affine;
mod connected_components;
mod cramer;
mod delay_approximation;
mod eigenvalues;
mod expand;
mod fraction;
mod kinks;
mod linearization;
mod local_analysis;
pub mod thresholds;
mod trigonometric_identity;

pub use affine::affine;
pub use connected_components::{Block, blocks};
pub use cramer::{Unsolved, solved};
pub use delay_approximation::{DelayState, delays_as_states};
pub use eigenvalues::{Mode, Stability, controllable_dimension, modes, stability};
pub use expand::expanded;
pub use fraction::Fraction;
pub use linearization::{Linear, NoLinear, Point, linear};
pub use local_analysis::{LocalAnalysis, NonsmoothPoint, clearly_different, near};
pub use trigonometric_identity::simplified;
