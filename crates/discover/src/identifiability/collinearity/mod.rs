//! Columns that depend on each other on these rows: how far, in which combinations, and why.
//!
//! In: a design. Out: the Gram matrix with its rank and condition, relations with their causes, other supports that fit as well.
//! Judges no equation.

pub mod causes;
pub mod equivalent_supports;
pub mod gram_matrix;
mod identity_test;
mod null_vectors;
pub mod relation;
pub mod restricted_isometry;
mod signal_relations;
pub mod term_relations;
