//! Units as an algebra: texts such as `kg*m/s^2` multiplied, divided, raised to powers, compared, simplified.
//!
//! In: texts, and terms whose signals have units. Out: units, or nothing if one is unknown. Converts no value: a unit says
//! what a number is counted in, and the number stays what it is.

mod exponent;
mod simplify;
mod term_units;
mod unit;
mod unit_parser;
mod unit_table;

pub use exponent::Exponent;
pub use term_units::{coefficient, derivative, of_term, of_time};
pub use unit::{Commensurability, Unit};
pub use unit_parser::{Misspelling, UnitSyntaxError, parse};
