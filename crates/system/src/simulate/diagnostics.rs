//! Diagnostics of simulation: why there is no run, and what was assumed for one.

use crate::discovery::Discovery;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::term::{Signal, SignalNames};

pub(super) fn nothing(d: &Discovery) -> Diagnostic {
    let failed: Vec<String> = d.failed.iter().map(|f| d.name(f.target)).collect();
    let out = Diagnostic::error("nothing-to-simulate", "the result has no equation");
    match failed.is_empty() {
        true => out.help("find the equations first: sidc identify MODEL.sid DATA.csv -o R.json"),
        false => out
            .fact(format!("not found: {}", failed.join(", ")))
            .help("why none was found is told by `sidc report R.json DATA.csv`"),
    }
}

pub(super) fn no_rows() -> Diagnostic {
    Diagnostic::error("no-samples", "the record has no rows to simulate along")
        .help("give a data file with times and inputs")
}

pub(super) fn unknown_signal(d: &Discovery, s: Signal) -> Diagnostic {
    Diagnostic::error(
        "no-signal",
        format!(
            "an equation mentions {}, which nothing in the system gives",
            d.name(s)
        ),
    )
    .help("write the result again with `sidc identify … -o R.json`")
}

pub(super) fn no_drive(d: &Discovery, s: Signal) -> Diagnostic {
    let name = d.name(s);
    Diagnostic::error(
        "no-signal",
        format!("the equations need {name}, and it is neither measured nor derivable"),
    )
    .help(format!("give data with a column for {name}"))
}

pub(super) fn no_start(d: &Discovery, s: Signal) -> Diagnostic {
    let name = d.name(s);
    Diagnostic::error(
        "no-start",
        format!("nothing says where {name} starts: it is neither measured nor derivable"),
    )
    .help(format!("--start {name}=VALUE"))
}

pub(super) fn no_start_row(d: &Discovery, state: &[Signal]) -> Diagnostic {
    let names: Vec<String> = state.iter().map(|s| d.name(*s)).collect();
    Diagnostic::error(
        "no-start",
        format!(
            "no row of the record has all that a start needs: {}",
            names.join(", ")
        ),
    )
    .help("look for empty cells, or give the start: --start NAME=VALUE,…")
}

pub(super) fn steps(h: f64, count: f64, most: f64) -> Diagnostic {
    Diagnostic::error(
        "too-many-steps",
        format!("steps of {h:e} are {count:.1e} of them; at most {most:.0e} are made"),
    )
    .help("take a longer --step, or none: error control takes the steps that are needed")
}

pub(super) fn restarts(count: usize) -> Diagnostic {
    let gaps = if count == 1 { "gap" } else { "gaps" };
    Diagnostic::note(
        "run-restarted",
        format!(
            "the run starts anew after {count} {gaps} in the record, where its inputs are unknown"
        ),
    )
}

pub(super) fn ends_at_gap(time: f64) -> Diagnostic {
    Diagnostic::warning(
        "run-restarted",
        format!(
            "the run ends at a gap in the record: nothing says where it would start again at t = {time}"
        ),
    )
}

pub(super) fn undefined_output(d: &Discovery, s: Signal, time: f64, rows: usize) -> Diagnostic {
    let name = d.name(s);
    let unit = if rows == 1 { "row" } else { "rows" };
    Diagnostic::warning(
        "output-undefined",
        format!("the output {name} has no finite value in {rows} {unit}, first at t = {time}"),
    )
    .help(format!(
        "look at the domain of the equation of {name}: logarithms, roots, denominators"
    ))
}

pub(super) fn driven(d: &Discovery, signals: &[Signal]) -> Diagnostic {
    let names: Vec<String> = signals.iter().map(|s| d.name(*s)).collect();
    let (have, drive) = match names.len() {
        1 => ("has", "its measurement drives"),
        _ => ("have", "their measurements drive"),
    };
    Diagnostic::note(
        "driven-state",
        format!(
            "{} {have} no equation: {drive} the others, linear between samples",
            names.join(", ")
        ),
    )
}

pub(super) fn input_slope(d: &Discovery, s: Signal, held: bool) -> Diagnostic {
    let name = d.name(s);
    let how = match (held, s.der) {
        (true, _) => "taken as 0: its input is held between samples",
        (false, 1) => "the slope of its input's straight lines between samples",
        _ => "taken as 0: its input is linear between samples",
    };
    Diagnostic::note(
        "input-slope",
        format!("{name} is not measured; it is {how}"),
    )
    .help(format!("measure {name}"))
}

pub(super) fn missing(d: &Discovery, s: Signal, count: usize, held: bool) -> Diagnostic {
    let (name, how) = (d.name(s), if held { "held" } else { "bridged" });
    let samples = if count == 1 { "sample" } else { "samples" };
    Diagnostic::note(
        "input-missing",
        format!("{count} missing {samples} of {name} {how} from those before"),
    )
}

pub(super) fn late(d: &Discovery, s: Signal, seconds: f64) -> Diagnostic {
    let name = d.name(s);
    let how = if seconds > 0.0 { "later" } else { "earlier" };
    Diagnostic::note(
        "input-late",
        format!(
            "{name} acts {} {} {how} than its record says",
            seconds.abs(),
            d.time_unit()
        ),
    )
}
