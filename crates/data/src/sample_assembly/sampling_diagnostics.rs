//! The constructors of the diagnostics about samples.

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, SignalNames};

use super::gathered_column::Provenance;
use super::signal_estimates::JumpCrossings;
use super::thresholds::SAMPLING;
use crate::dataset::Trajectory;

pub(super) fn no_signal(model: &Model, trajectory: &Trajectory, signal: Signal) -> Diagnostic {
    let name = model.name(signal);
    let base = model.name(Signal::new(signal.var));
    let d = Diagnostic::error(
        "no-signal",
        format!(
            "{}: {name} is neither measured nor derivable",
            trajectory.name
        ),
    );
    if signal.der > SAMPLING.max_differentiations {
        return d.help(format!("derivatives are estimated up to three orders above a measured one; measure one nearer to {name}"));
    }
    d.help(format!("data {{ {base} = \"HEADER\" }}"))
}

pub(super) fn no_samples(rows: usize) -> Diagnostic {
    Diagnostic::error(
        "no-samples",
        format!("none of the {rows} rows has all the signals that the equations need"),
    )
    .help("look for empty cells, or for records too short to take derivatives or shifts")
}

pub(super) fn rows_left_out(count: usize, all: usize, discrete: bool) -> Diagnostic {
    let why = if discrete {
        "a value is missing, or a shift reaches beyond the record"
    } else {
        "a value is missing, or too few samples stand between gaps or jumps of an input"
    };
    Diagnostic::note(
        "rows-left-out",
        format!("{count} of {all} rows lack a signal and are left out"),
    )
    .fact(why)
}

pub(super) fn input_changes_often(crossings: JumpCrossings) -> Diagnostic {
    let percent = 100.0 * crossings.crossed as f64 / crossings.rows.max(1) as f64;
    Diagnostic::warning(
        "input-changes-often",
        format!("{percent:.0} % of the rows lie between jumps of an input fewer than 5 samples apart"),
    )
    .fact("derivatives there are estimated across the jumps, with large errors")
    .help("sample faster than the input is set, measure the derivatives, or declare the input linear if it is smooth")
}

pub(super) fn noisy_derivative(model: &Model, p: &Provenance, error: f64) -> Diagnostic {
    let name = model.name(p.signal);
    Diagnostic::warning(
        "noisy-derivative",
        format!(
            "the estimate of {name} is off by about {:.0} % of its size",
            100.0 * error / p.rms
        ),
    )
    .fact(format!(
        "typical error {error:.3e}, rms of {name} {:.3e}",
        p.rms
    ))
    .help(format!(
        "measure {name}, sample faster, or declare the sensor's noise"
    ))
}
