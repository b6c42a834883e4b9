//! Φ as an operator, stored or as products of factors.

mod block;
mod dense;
mod factored;
mod graded;
mod grades;
mod joined;
mod operator;
mod pricing;
mod unit_columns;

pub use block::Block;
pub use dense::Dense;
pub use factored::{Factored, NotFinite};
pub use graded::Graded;
pub use grades::Grades;
pub use joined::Joined;
pub use operator::Dictionary;
pub use pricing::{Priced, PricingCollector};
pub(crate) use unit_columns::{unit_columns, usable_columns};
