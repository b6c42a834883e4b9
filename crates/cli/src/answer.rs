//! What `identify` prints and writes beside the equations: rows, signals, settings.

use super::identify::{Args, Candidate, Found};
use super::values::Held;
use super::{Failure, candidates, inputs};
use sidc::pipeline::{self, Measured, Program};
use sidc_emit as emit;
use sidc_lang::diagnostic::{Diagnostic, Severity};
use sidc_lang::term::SignalNames;
use sidc_system::discovery::Notice;
use sidc_system::result;
use sidc_system::result::{CandidateEntry, Settings};

/// The terminal's answer.
pub fn text(
    args: &Args,
    candidate: &Candidate,
    found: &Found,
    others: &[CandidateEntry],
) -> String {
    let (program, measured, d) = (&candidate.program, &candidate.measured, &found.discovery);
    let mut text = String::new();
    if !others.is_empty() {
        text.push_str(&candidates::table(others, program.model.discrete));
        text.push('\n');
    }
    let rows = measured.rows();
    let drawn = match args.samples {
        Some(n) if (n as usize) < rows => format!(" ({n} drawn, seed {})", args.seed),
        _ => String::new(),
    };
    let rows = match rows {
        0 => "no rows were ready".into(),
        n if measured.joint.is_some() => format!("{n} samples"),
        n => format!("{n} rows{drawn}"),
    };
    text.push_str(&format!(
        "{}: {rows} from {}\n\n",
        d.system.as_deref().unwrap_or("system"),
        trajectories(measured)
    ));
    text.push_str(&emit::answer(d, args.evidence));
    text.push_str(&emit::consequences(d));
    text.push('\n');
    if let Some(validation) = &found.validation {
        text.push_str(&emit::validation(validation));
        text.push('\n');
    }
    text.push_str(&signals_text(program, measured));
    text
}

/// The one trajectory by name, several by their number.
pub fn trajectories(measured: &Measured) -> String {
    match measured.dataset.trajectories.as_slice() {
        [one] => one.name.clone(),
        many => format!("{} trajectories", many.len()),
    }
}

/// What was measured and what was estimated, and how.
pub fn signals_text(program: &Program, measured: &Measured) -> String {
    let entries = pipeline::signal_entries(program, measured);
    let columns = measured.dataset.trajectories.first().map(|t| &t.columns);
    let columns: Vec<String> = columns
        .into_iter()
        .flatten()
        .map(|(signal, _)| program.model.name(*signal))
        .collect();
    let mut text = format!("measured: {}\n", columns.join(", "));
    for e in &entries {
        if let Some(error) = e.error {
            text.push_str(&format!(
                "estimated: {} by {}, error about {} of its size\n",
                e.signal,
                e.origin,
                sidc_lang::number::significant(error, 2)
            ));
        }
    }
    text
}

/// The result document.
pub fn document(
    args: &Args,
    candidate: &Candidate,
    found: &Found,
    others: &[CandidateEntry],
) -> Result<String, Failure> {
    let beside = result::Beside {
        settings: settings(args, candidate),
        signals: pipeline::signal_entries(&candidate.program, &candidate.measured),
        warnings: candidate.warnings.clone(),
        validation: found.validation.clone(),
        candidates: others.to_vec(),
    };
    result::write(&found.discovery, beside)
        .map_err(|e| Failure::new(format!("error[internal]: {e}; please report this")))
}

fn settings(args: &Args, candidate: &Candidate) -> Settings {
    let held = |h: &Held| match h {
        Held::Stretch(stretch) => stretch.to_string(),
        Held::File(path) => inputs::short_name(path),
    };
    Settings {
        model: inputs::short_name(&candidate.path),
        data: candidate
            .measured
            .dataset
            .trajectories
            .iter()
            .map(|t| t.name.clone())
            .collect(),
        method: args.method.chosen().into(),
        solver: args.solver.name().into(),
        samples: args.samples.map(|n| n as usize),
        seed: args.seed,
        window: args.window,
        holdout: args.holdout.iter().map(held).collect(),
        params: args.params.clone(),
        robust: args.robust,
        files: candidate.origin.files.clone(),
        source: candidate.origin.text.clone(),
        reading: pipeline::reading(&candidate.program, &candidate.measured),
    }
}

/// Warnings travel with the result; notes do not.
pub fn said(diagnostics: &[Diagnostic]) -> Vec<Notice> {
    diagnostics
        .iter()
        .filter(|d| d.severity == Severity::Warning)
        .map(|d| Notice::new(d.code, &d.message))
        .collect()
}
