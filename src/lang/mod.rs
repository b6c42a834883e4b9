//! The `.sid` language: text → ast → checked model, with diagnostics that carry places.
//!
//! Knows nothing of data, numbers or solvers.

pub mod diagnostic;
pub mod model;
pub mod source;
