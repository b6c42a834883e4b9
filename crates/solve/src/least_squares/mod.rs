//! Least squares: on the whole library, on a support, and on all supports at once as a quadratic form.

mod conditioned_columns;
mod minimum_norm;
mod quadratic_form;
mod refit;

pub use conditioned_columns::SingleChange;
pub use minimum_norm::{LeastSquares, minimum_norm_least_squares};
pub use quadratic_form::QuadraticForm;
pub use refit::{Refit, refit};
