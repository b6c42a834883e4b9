//! Buffers of the integration.
//!
//! In: nothing. Out: room that blocks of intervals share, so that none is taken anew.

use super::compiled_laws::{LocalLinearization, Scratch};
use super::sliding_flow::SlidingFlow;
use super::state_transition::StateTransition;

/// Buffers that blocks share. Of every three, the first belongs to the start of a step, the second to its middle, the third to its end.
#[derive(Default)]
pub(crate) struct Workspace {
    pub(super) scratch: Scratch,
    pub(super) sliding: SlidingFlow,
    pub(super) points: [Vec<f64>; 3],
    pub(super) local: [LocalLinearization; 3],
    /// Values of all columns.
    pub(super) values: [Vec<f64>; 3],
    pub(super) jacobians: [Vec<f64>; 3],
    /// What a unit of each law's right side there adds to the end state: n × laws × intervals.
    pub(super) gains: [Vec<f64>; 3],
    pub(super) stage: Vec<f64>,
    pub(super) rates: [Vec<f64>; 4],
    pub(super) tape: Vec<f64>,
    /// Rates at the start of the previous block, laws × INTERVALS_AT_ONCE: first guesses for implicit laws.
    pub(super) guess: Vec<f64>,
    pub(super) transition: StateTransition,
    /// T from the start of the intervals to the present step.
    pub(super) reached: Vec<f64>,
    pub(super) moved: Vec<f64>,
    /// Slots of intervals in which a switch changes its side.
    pub(super) eventful: Vec<usize>,
    /// Steps that each slot wants.
    pub(super) steps: Vec<usize>,
}

impl Workspace {
    /// First guesses of the rates, which implicit laws are solved from: with the same ones a block comes out the same.
    pub fn first_guess(&self) -> &[f64] {
        &self.guess
    }

    pub fn set_first_guess(&mut self, guess: &[f64]) {
        guess.clone_into(&mut self.guess);
    }
}
