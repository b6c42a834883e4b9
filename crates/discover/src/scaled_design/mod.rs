//! The columns of an equation, scaled to length one, on the rows it was found from.
//!
//! In: a library, samples, the equation found. Out: unit columns, target and noise, for questions about what the data can tell apart.

mod design_columns;
mod orthonormal_basis;
pub(crate) mod thresholds;

pub use design_columns::{Noise, ScaledColumn, ScaledDesign};
pub use orthonormal_basis::OrthonormalBasis;
