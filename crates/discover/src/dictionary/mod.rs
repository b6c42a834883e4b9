//! The dictionary Φ: the terms of a library evaluated on samples, stored as a matrix or left as factors.
//!
//! In: a library, samples, row weights. Out: a [`sidc_solve::dictionary::Dictionary`] whose columns are the library's slots, or the first
//! term that is not finite. `compile` chooses the form; `factor_table` evaluates every power once, `column_products` multiplies them,
//! `expression_values` evaluates expressions along rows. Solves nothing.

mod column_products;
mod compile;
mod continuum;
mod expression_values;
mod factor_table;
mod grades;

#[cfg(test)]
mod tests;

pub use compile::{BadValue, bytes, compile, evaluate, subtract};
pub(crate) use continuum::{Continuum, ContinuumColumns};
pub use grades::{grades, variations};
