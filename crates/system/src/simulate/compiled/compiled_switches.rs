//! Guards of switches, compiled.
//!
//! In: the switches of a form. Out: one list of operations for the guards and their gradients. Evaluates nothing.

use crate::discovery::Form;
use crate::switching::Switches;
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
        Ok(Some(CompiledSwitches {
            count: switches.len(),
            tape: PointTape::new(&outputs, signals)?,
            by_state,
            by_input,
            by_time: by_time.into_iter().map(|(k, _)| k).collect(),
        }))
    }

    pub fn slots(&self) -> Vec<f64> {
        self.tape.slots()
    }
}
