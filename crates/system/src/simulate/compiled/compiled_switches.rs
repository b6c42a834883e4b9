//! Guards of switches, compiled.
//!
//! In: the switches of a form. Out: one list of operations for the guards and their gradients. Evaluates nothing.

use crate::discovery::Form;
use crate::switching::{Contact, Mode, Modes, ResetMap, Switches};
use sidc_lang::term::{Expr, PointTape, Signal};

/// Guards and their gradients, compiled.
#[derive(Clone, Debug)]
pub(crate) struct CompiledSwitches {
    pub count: usize,
    /// Guards, then the derivatives of `by_state`, `by_input`, `by_time`.
    pub(super) tape: PointTape,
    /// Guard and state of each derivative.
    pub(super) by_state: Vec<(usize, usize)>,
    /// Guard and input of each derivative.
    pub(super) by_input: Vec<(usize, usize)>,
    /// Guards that move with time alone.
    pub(super) by_time: Vec<usize>,
    /// Where states jump.
    pub(super) resets: Vec<CompiledReset>,
    pub(super) contacts: Vec<Contact>,
    pub(super) first_modes: Modes,
}

/// States that jump where a guard leaves one of its sides.
#[derive(Clone, Debug)]
pub(crate) struct CompiledReset {
    pub(super) switch: usize,
    pub(super) leaves: Mode,
    /// The states that jump.
    pub(super) states: Vec<usize>,
    /// Their values after it.
    pub(super) values: PointTape,
}

impl CompiledSwitches {
    /// `None` where nothing switches; `Err` is a signal that no argument gives.
    pub fn new(
        switches: &Switches,
        form: &Form,
        signals: &[Signal],
    ) -> Result<Option<CompiledSwitches>, Signal> {
        if switches.is_empty() {
            return Ok(None);
        }
        let mut outputs: Vec<Expr> = switches.guards.clone();
        let mut slopes = |signals: &[Signal]| {
            let mut entries = Vec::new();
            for (k, guard) in switches.guards.iter().enumerate() {
                for (i, s) in signals.iter().enumerate() {
                    if guard.mentions(*s) {
                        outputs.push(guard.derivative(*s));
                        entries.push((k, i));
                    }
                }
            }
            entries
        };
        let by_state = slopes(&form.state);
        let by_input = slopes(&form.inputs);
        let by_time = slopes(&[Signal::TIME]);
        let resets = switches.resets.iter();
        let resets = resets.map(|r| CompiledReset::new(r, form, signals));
        Ok(Some(CompiledSwitches {
            count: switches.len(),
            tape: PointTape::new(&outputs, signals)?,
            by_state,
            by_input,
            by_time: by_time.into_iter().map(|(k, _)| k).collect(),
            resets: resets.collect::<Result<_, Signal>>()?,
            contacts: switches.contacts.clone(),
            first_modes: switches.first_modes(),
        }))
    }

    pub fn slots(&self) -> Vec<f64> {
        self.tape.slots()
    }
}

impl CompiledReset {
    fn new(reset: &ResetMap, form: &Form, signals: &[Signal]) -> Result<CompiledReset, Signal> {
        let (mut states, mut values) = (Vec::new(), Vec::new());
        for (signal, value) in &reset.jumps {
            let state = form.state.iter().position(|s| s == signal);
            states.push(state.ok_or(*signal)?);
            values.push(value.clone());
        }
        Ok(CompiledReset {
            switch: reset.switch,
            leaves: reset.leaves,
            states,
            values: PointTape::new(&values, signals)?,
        })
    }
}
