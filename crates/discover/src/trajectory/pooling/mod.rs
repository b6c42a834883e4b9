//! Several records of one plant: what each of them says alone of laws that were found from all.
//!
//! In: a problem and a fit. Out: each run's own coefficients, the terms whose coefficients differ between runs, and how far laws follow
//! a record. Chooses no terms.

mod followed_stretch;
mod run_estimates;

pub use followed_stretch::RunNotFollowed;
pub(crate) use followed_stretch::left_by;
pub(crate) use run_estimates::fit_by_run;
pub use run_estimates::{Differing, RunValue, differing_coefficients};
