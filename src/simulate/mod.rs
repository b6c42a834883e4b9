//! Free runs of found equations: from a measured start, under the measured inputs, compared with what was measured.
//!
//! In: a [`Discovery`], a model that says how data were read, a [`Dataset`]. Out: a [`Run`] with its scores. Never estimates
//! anything of the equations, reads no files, prints nothing.

mod course;
mod drives;
mod elimination;
mod explicit;
mod fault;
mod figures;
mod flow;
mod maps;
mod march;
mod plant;
mod prepare;
mod reads;
mod refusals;
mod routine;
mod run;
mod score;
mod settle;
mod start;
mod stiff;

pub use fault::{Fault, FaultKind};
pub use figures::{EXACT, Figures};
pub use prepare::simulate;
pub use reads::reads;
pub use run::{BOUND, Leg, METHODS, Method, Options, Origin, Run, Score, Start, Work};

use crate::data::Dataset;
use crate::discover::Discovery;
use crate::lang::model::Model;

/// What is simulated: equations, what is known of their signals, and the records.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    pub discovery: &'a Discovery,
    /// Declares the discovery's variables, in its order; its equations are not looked at.
    pub model: &'a Model,
    pub dataset: &'a Dataset,
}
