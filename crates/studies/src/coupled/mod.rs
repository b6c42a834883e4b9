//! Random coupled mechanical systems: from how many rows basis pursuit finds their laws, plain and with graded norms.
//!
//! In: systems of `sidc_testing::plants::coupled`, libraries, gradings. Out: trials. Solves by the default solver and does nothing
//! afterwards: no criterion, no refit.

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
