//! Studies of `sidc`: what the documents' figures come from, one program each in `src/bin`.
//!
//! Here is what several programs or the tests use; each study runs what `sidc identify` runs, on records of known systems.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod coupled;
pub mod coverage;
pub mod decorrelation;
pub mod planted;
pub mod reproduce;
pub mod success_plot;
