//! Φ as an operator, stored or as products of factors.

mod dense;
mod factored;
mod graded;
mod operator;
mod pricing;
mod unit_columns;

pub use dense::Dense;
pub use factored::{Block, Factored, NotFinite};
pub use graded::{Graded, Grades};
pub use operator::Dictionary;
pub use pricing::{Priced, PricingCollector};
pub(crate) use unit_columns::{unit_columns, usable_columns};
