//! What the example programs share: an accurate integrator, a small random generator and a table writer.
//!
//! In: right-hand sides as closures. Out: tables that sidc reads. Uses nothing of the compiler: the data it is
//! tested on must not come from its own code.

pub mod integrate;
pub mod random;
pub mod table;
