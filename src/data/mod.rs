//! Measured data: CSV text → trajectories of named signals → samples.
//!
//! In: a reader and the model's data block. Out: a [`Dataset`], and from it [`Samples`] with every signal that the model's
//! equations need, measured or estimated. Only `cli` opens files.

mod dataset;
mod samples;

pub use dataset::{Dataset, Trajectory};
pub use samples::{Column, Origin, Samples};
