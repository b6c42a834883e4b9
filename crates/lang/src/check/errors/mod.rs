//! Errors in the meaning of a model, by kind of statement.
//!
//! Constructors only. In: places and names. Out: a [`crate::diagnostic::Diagnostic`] with a fix to copy.

mod attributes;
mod data_entries;
mod declarations;
mod equations;
mod expressions;
mod families;
mod functions;
mod hidden_states;
mod resets;
mod symmetries;
mod unit_mismatch;

pub use attributes::*;
pub use data_entries::*;
pub use declarations::*;
pub use equations::*;
pub use expressions::*;
pub use families::*;
pub use functions::*;
pub use hidden_states::*;
pub use resets::*;
pub use symmetries::*;
pub use unit_mismatch::*;
