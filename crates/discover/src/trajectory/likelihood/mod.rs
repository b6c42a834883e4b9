//! The likelihood of a support and its linearisations.
//!
//! In: a problem, a point or a support. Out: a [`Fit`] with its criterion and standard errors; quadratic forms in all coefficients,
//! from which supports are proposed. Tries no supports of its own.

mod block_products;
mod criterion;
mod gauss_newton;
mod integral_matching;
mod linearization;
mod sandwich_covariance;
mod step_halving;

pub use block_products::{BlockProducts, block_products};
pub use criterion::term_price;
pub(crate) use criterion::{PenalizedLikelihood, final_floor};
pub use gauss_newton::Fit;
pub(crate) use gauss_newton::fit;
pub(crate) use sandwich_covariance::set_variances;
