//! The sections of the report, a file each: a [`super::Subject`] as HTML.

mod coefficient_correlation;
pub(crate) mod coefficients;
pub(crate) mod collinearity;
mod correlation;
pub(crate) mod data_coverage;
pub(crate) mod equations;
pub(crate) mod error_by_terms;
pub(crate) mod phase_portraits;
pub(crate) mod prediction;
mod prediction_bands;
pub(crate) mod reasons;
pub(crate) mod reproduction;
mod residual_correlation;
mod residual_means;
mod residual_spectrum;
pub(crate) mod residuals;
pub(crate) mod trajectories;
pub(crate) mod verdict;
