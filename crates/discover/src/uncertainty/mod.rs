//! Inference about each term that was found: confidence interval, stability, the best equation without it, and a mark.
//!
//! In: the normal equations behind an equation, for each block of the records. Out: a [`sidc_system::discovery::TermEvidence`] for every
//! term found. Never changes a term or a coefficient, never prints.

mod confidence_intervals;
mod drop_one_refit;
mod error_correlations;
mod omitted_terms;
mod row_blocks;
mod stability_selection;
mod target_regression;
mod term_assessment;
pub(crate) mod term_identity;
pub(crate) mod thresholds;

#[cfg(test)]
mod tests;

pub use confidence_intervals::confidence_intervals;
pub use row_blocks::block_normal_equations;
pub use stability_selection::{Stability, stability_selection};
pub use term_assessment::{assess_terms, doubt_unneeded_terms, mark_terms};
