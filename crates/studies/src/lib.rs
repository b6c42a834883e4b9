//! Studies of `sidc`, one program per study in `src/bin`: they produce the figures in the documentation.
//!
//! This library holds what several programs or the tests use. Each study runs what `sidc identify` runs, on records of known systems.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod coupled;
pub mod coverage;
pub mod decorrelation;
pub mod planted;
pub mod reproduce;
pub mod success_plot;
