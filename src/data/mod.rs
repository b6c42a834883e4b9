//! Measured data: CSV text → trajectories of named signals → samples.
//!
//! In: a reader and the model's data block. Out: a [`Dataset`], and from it [`Samples`] with every signal that the model's
//! equations need, measured or estimated. Only `cli` opens files.

mod bind;
mod breaks;
mod checks;
mod clock;
mod columns;
mod csv;
mod dataset;
mod derivatives;
mod figure;
mod holdout;
mod inputs;
mod instants;
mod missing;
mod piece;
mod samples;
mod sampling;
mod smooth;
mod window;

pub use bind::bind;
pub use breaks::breaks;
pub(crate) use csv::plain;
pub use csv::{Limits, Table, bad_cells, read, too_large};
pub use dataset::{Dataset, Input, Trajectory};
pub use holdout::{HoldOut, Stretch, hold_out};
pub use instants::{gaps, pieces, settled};
pub use samples::{Column, Origin, Samples};
pub use sampling::{Provenance, SignalMonitor, samples};
pub use smooth::{Break, Smoothed, smooth};
pub use window::{Window, keep_window};
