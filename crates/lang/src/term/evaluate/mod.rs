//! Expressions as straight-line code: one arithmetic, run at one point or at many.
//!
//! [`Graph`] finds common subexpressions, [`Tape`] runs blocks of points in few registers, [`PointTape`] runs one point in a buffer
//! that is kept. Both run the operations of `operation.rs`, so that their numbers agree to the last bit.

mod expression_graph;
mod operation;
mod point_tape;
mod tape;

pub use expression_graph::{Graph, Node};
pub use point_tape::PointTape;
pub use tape::Tape;
