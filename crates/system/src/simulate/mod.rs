//! Free runs of found equations: from a measured start, under the measured inputs, compared with the measurements.
//!
//! In: a [`Discovery`], a model that says how data were read, a [`Dataset`]. Out: a [`Run`] with its scores. Never
//! estimates coefficients, reads no files, prints nothing.

mod compiled;
mod contiguous_legs;
mod diagnostics;
mod fault;
mod forced_right_side;
mod initial_state;
mod inputs;
mod integrate;
mod record_path;
mod record_simulation;
mod required_signals;
mod right_side;
mod run;
mod sampled_start;
mod scores;
mod segment_runs;
mod stiff;
pub mod thresholds;

#[cfg(test)]
mod event_tests;

pub use fault::{Fault, FaultKind};
pub use record_simulation::simulate;
pub use required_signals::reads;
pub use right_side::RightSide;
pub use run::{Leg, METHODS, Method, Options, Origin, Run, Score, Start, Work};
pub use scores::document::{EXACT, Figures};
pub use segment_runs::{SegmentRun, SegmentRuns};

use crate::discovery::Discovery;
use sidc_data::Dataset;
use sidc_lang::model::Model;

/// The equations and the records to simulate.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    pub discovery: &'a Discovery,
    /// Declares the variables of the discovery in the same order; its equations are ignored.
    pub model: &'a Model,
    pub dataset: &'a Dataset,
}
