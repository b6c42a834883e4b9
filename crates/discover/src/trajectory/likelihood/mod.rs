//! The likelihood of a support and its linearisations.
//!
//! In: a problem, a point or a support. Out: a [`Fit`] with its criterion and standard errors; quadratic forms in all coefficients,
//! from which supports are proposed. Tries no supports of its own.

mod block_products;
mod criterion;
mod disturbed_fit;
mod eliminated_records;
mod fitted_support;
mod gauss_newton;
mod integral_matching;
mod kalman_filter;
mod linearization;
mod noise_estimation;
mod quasi_newton;
mod sandwich_covariance;
mod step_halving;
mod support_fit;
mod sweep;
pub(super) mod thresholds;

pub use block_products::{BlockProducts, block_products};
pub use criterion::term_price;
pub(crate) use criterion::{PenalizedLikelihood, final_floor};
pub(crate) use disturbed_fit::{innovations, undisturbed_value};
pub(crate) use eliminated_records::EliminatedRecords;
pub use fitted_support::Fit;
pub(crate) use fitted_support::is_hopeless;
pub(crate) use kalman_filter::Innovation;
pub(crate) use sandwich_covariance::set_variances;
pub(crate) use support_fit::fit;
