//! Random coupled mechanical systems: how many rows basis pursuit needs for their laws, with plain and graded norms.
//!
//! In: systems of `sidc_testing::plants::coupled`, libraries, gradings. Out: trials. Uses the default solver alone, without criterion or refit.

mod dictionary;
mod grading;
mod identified;
mod library;
mod run;
#[cfg(test)]
mod tests;
mod trial;

pub use grading::{GRADINGS, Grading, Measure, degree, variation};
pub use identified::identified;
pub use library::Size;
pub use run::{Case, Plan, Trial, cases, trials};
pub use trial::Outcome;
