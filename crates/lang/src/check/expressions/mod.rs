//! What expressions mean: numbers, terms, sets of terms, and their units.

mod arithmetic;
mod dimensional_analysis;
mod function_calls;
mod inlined_size;
mod library_expr;
mod set_algebra;

pub use set_algebra::union;
