//! Where states jump: their values after it, with the derivatives by what was before.
//!
//! In: states that jump at a guard, as written; a point. Out: r(z), ∂r/∂z, and ∂r by each exogenous signal.

use nalgebra::DMatrix;

use sidc_lang::term::{Expr, Signal, Tape};
use sidc_system::switching::{Mode, ResetMap};

/// States that jump where a guard leaves one of its sides, compiled.
pub(crate) struct StateJump {
    pub switch: usize,
    /// The side that the guard leaves.
    pub leaves: Mode,
    /// The states that jump.
    targets: Vec<usize>,
    /// Their values after the jump, then the derivatives of each by every state and exogenous signal.
    values: Tape,
    states: usize,
    exogenous: usize,
}

/// The state after a jump, linearised.
pub(super) struct Jumped {
    pub state: Vec<f64>,
    /// ∂r/∂z, states × states.
    pub by_state: DMatrix<f64>,
    /// States × exogenous signals.
    pub by_exogenous: DMatrix<f64>,
}

impl StateJump {
    /// `signals`: states, rates, exogenous signals; `inputs`: the rows of points. `None` if something else than a state of a law jumps.
    pub fn new(
        reset: &ResetMap,
        (states, laws): (usize, usize),
        (signals, inputs): (&[Signal], &[Signal]),
    ) -> Option<StateJump> {
        let sources = || signals[..states].iter().chain(&signals[states + laws..]);
        let mut targets = Vec::new();
        let mut all: Vec<Expr> = reset.jumps.iter().map(|(_, value)| value.clone()).collect();
        for (signal, value) in &reset.jumps {
            targets.push(signals[..states].iter().position(|s| s == signal)?);
            all.extend(sources().map(|s| value.derivative(*s)));
        }
        Some(StateJump {
            switch: reset.switch,
            leaves: reset.leaves,
            targets,
            values: Tape::new(&all, inputs).ok()?,
            states,
            exogenous: signals.len() - states - laws,
        })
    }

    /// Adds this jump to those that happen at the same instant; `point` is the one before all of them.
    pub(super) fn apply(&self, point: &[f64], work: &mut Vec<f64>, after: &mut Jumped) {
        let mut out = vec![0.0; self.values.outputs()];
        self.values.eval(point, 1, &mut out, work);
        let (values, slopes) = out.split_at(self.targets.len());
        let rows = slopes.chunks_exact(self.states + self.exogenous);
        for ((target, value), row) in self.targets.iter().zip(values).zip(rows) {
            after.state[*target] = *value;
            for (j, slope) in row[..self.states].iter().enumerate() {
                after.by_state[(*target, j)] = *slope;
            }
            for (j, slope) in row[self.states..].iter().enumerate() {
                after.by_exogenous[(*target, j)] = *slope;
            }
        }
    }
}

impl Jumped {
    /// Nothing jumps.
    pub fn none(state: &[f64], exogenous: usize) -> Jumped {
        let n = state.len();
        Jumped {
            state: state.to_vec(),
            by_state: DMatrix::identity(n, n),
            by_exogenous: DMatrix::zeros(n, exogenous),
        }
    }
}
