//! Random coupled mechanical systems: from how many rows basis pursuit finds their laws, plain and with graded norms.
//!
//! In: systems of `sidc_testing::plants::coupled`, libraries, gradings. Out: trials, one a line, and tables of them. Solves by the default
//! solver and does nothing afterwards: no criterion, no refit.

mod dictionary;
mod grading;
mod library;
mod trial;

pub use dictionary::Tabulated;
pub use grading::{GRADINGS, Grading, Measure};
pub use library::{Library, Size};
pub use trial::{Outcome, outcome};
