//! What a result document says of model, data and options, besides the equations.
//!
//! In: a program, its measured signals, the options. Out: entries of the document. Computes nothing.

use sidc_lang::diagnostic::{Diagnostic, Severity};
use sidc_lang::term::SignalNames;
use sidc_system::discovery::Notice;
use sidc_system::result::{FileEntry, Reading, Settings, SignalEntry};

use super::measure::Measured;
use super::program::Program;
use crate::data::Data;
use crate::options::Options;

/// A model as it was given.
#[derive(Clone, Debug)]
pub struct ModelSource {
    /// Its name in messages and results.
    pub name: String,
    pub text: String,
    /// The file of the model, then those of the data; empty if nothing was read from files.
    pub files: Vec<FileEntry>,
}

/// What it takes to repeat a run: model, data, options.
pub fn settings(
    source: &ModelSource,
    program: &Program,
    measured: &Measured,
    data: &Data,
    options: &Options,
) -> Settings {
    let records = &measured.dataset.trajectories;
    let search = &options.search;
    Settings {
        model: source.name.clone(),
        data: records.iter().map(|t| t.name.clone()).collect(),
        method: search.method.chosen().into(),
        solver: search.solver.name().into(),
        samples: search.samples,
        seed: search.seed,
        window: (options.window != (None, None)).then_some(options.window),
        holdout: measured.held_out.clone(),
        prediction: options.prediction.clone(),
        params: data.params.clone(),
        robust: search.robust,
        files: source.files.clone(),
        source: source.text.clone(),
        reading: reading(program, measured),
    }
}

/// The warnings among diagnostics, which the result keeps.
pub fn warnings<'a>(diagnostics: impl IntoIterator<Item = &'a Diagnostic>) -> Vec<Notice> {
    let all = diagnostics.into_iter();
    all.filter(|d| d.severity == Severity::Warning)
        .map(|d| Notice::new(d.code, &d.message))
        .collect()
}

/// What was measured and what was estimated, and how.
pub fn signal_entries(program: &Program, measured: &Measured) -> Vec<SignalEntry> {
    let model = &program.model;
    let recorded = (measured.report.iter()).filter(|r| !model.is_constant(r.signal.var));
    let entries = recorded.map(|r| SignalEntry {
        signal: program.model.name(r.signal),
        origin: r.method.clone(),
        error: r.error.map(|e| e / r.rms.max(f64::MIN_POSITIVE)),
    });
    entries.collect()
}

/// How the data were read, with the intersample behaviour chosen for each input.
fn reading(program: &Program, measured: &Measured) -> Reading {
    let mut as_read = program.model.clone();
    for input in &measured.dataset.inputs {
        if let Some(var) = as_read.vars.get_mut(usize::from(input.var.0)) {
            var.between = Some(input.between);
        }
    }
    Reading::of(&as_read)
}
