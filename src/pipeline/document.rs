//! What a result document says of its data, beside the equations.

use sidc_lang::term::SignalNames;
use sidc_system::result::{Reading, SignalEntry};

use super::{Measured, Program};

/// What was measured and what was estimated, and how.
pub fn signal_entries(program: &Program, measured: &Measured) -> Vec<SignalEntry> {
    let entries = measured.report.iter().map(|r| SignalEntry {
        signal: program.model.name(r.signal),
        origin: r.method.clone(),
        error: r.error.map(|e| e / r.rms.max(f64::MIN_POSITIVE)),
    });
    entries.collect()
}

/// How the data were read, courses of inputs as they were decided.
pub fn reading(program: &Program, measured: &Measured) -> Reading {
    let mut as_read = program.model.clone();
    for input in &measured.dataset.inputs {
        if let Some(var) = as_read.vars.get_mut(usize::from(input.var.0)) {
            var.between = Some(input.between);
        }
    }
    Reading::of(&as_read)
}
