//! What can be wrong with the meaning of a model, by the kind of statement it is about.
//!
//! Constructors only: places and names in, a [`crate::lang::diagnostic::Diagnostic`] with a fix to copy out.

mod data;
mod equations;
mod names;
mod restrict;
mod terms;
mod units;

pub use data::*;
pub use equations::*;
pub use names::*;
pub use restrict::*;
pub use terms::*;
pub use units::*;
