//! Doubts about an equation: rules that turn evidence into doubts, and the statistics that they judge by.
//!
//! In: evidence, residuals, states. Out: reasons. Never changes an equation.

pub(crate) mod badly_fitted_rows;
pub(crate) mod constant_rules;
pub(crate) mod dependent_states;
pub(crate) mod pooling_rules;
pub(crate) mod regression_rules;
pub(crate) mod residual_autocorrelation;
pub(crate) mod thresholds;
pub(crate) mod trajectory_rules;
