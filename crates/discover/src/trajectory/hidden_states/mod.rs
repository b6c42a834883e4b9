//! Where the search starts that has states which nothing measures.
//!
//! In: a problem with hidden states, values of its constants. Out: the same problem with a course of each hidden state and columns to start from;
//! values of constants from which laws that are given lead along the readings. Estimates nothing exactly: the search does.

mod constant_values;
mod exchanged_parameters;
mod filtered_course;
mod first_values;
mod given_course;
mod hidden_laws;
mod observed_fit;
mod offset;
mod run_fit;
mod scale;
mod sensitive_laws;
mod solved_course;
mod start;
pub(crate) mod thresholds;

pub(crate) use constant_values::likely_constants;
pub(crate) use exchanged_parameters::{exchanged_constants, exchanged_lags};
pub(super) use first_values::between;
pub(crate) use run_fit::constants_by_runs;
pub use scale::ReportedScale;
pub(crate) use scale::with_told_scales;
pub(super) use sensitive_laws::SensitiveLaws;
pub(crate) use start::{fit_proposed, with_sparsest_offset, with_started_states};
pub(crate) use thresholds::HIDDEN;
