//! The warnings that go with exported code and formulas: the verdict with its reasons, and the delays of inputs and sensors.
//!
//! In: a discovery. Out: lines for a comment, a text for a constant, a delay for each input. The texts contain no quotes, no backslashes
//! and no end of a comment, so that they are safe in every language.

use crate::code::identifiers::{comment_safe, plain};
use crate::text::disturbance;
use crate::text::layout::wrapped;
use sidc_lang::number::significant;
use sidc_lang::term::{Language, Signal, SignalNames, VarId};
use sidc_system::discovery::{Discovery, RunCoefficient};
use sidc_system::verdict::{self, LawVerdict};

/// Longest line of a comment in characters, without the comment mark.
const WIDTH: usize = 110;

/// The verdict in one line, names and codes only: `passes`, or `doubted: ddx misfit, tie; dy few-rows`.
pub(crate) fn verdict_summary(d: &Discovery) -> String {
    let law = LawVerdict::of(d);
    match codes(d) {
        each if law == LawVerdict::Passes || each.is_empty() => law.as_str().into(),
        each => format!("{}: {each}", law.as_str()),
    }
}

/// The codes of all reasons, equation by equation: `ddx misfit, tie; dy few-rows`.
fn codes(d: &Discovery) -> String {
    let mut targets: Vec<(String, Vec<String>)> = Vec::new();
    for (target, reason) in verdict::reasons(d) {
        let code = plain(reason.code.as_str());
        match targets.iter_mut().find(|(t, _)| *t == target) {
            Some((_, codes)) => codes.push(code),
            None => targets.push((target, vec![code])),
        }
    }
    let each = targets.iter();
    let each: Vec<String> = each
        .map(|(t, codes)| format!("{} {}", plain(t), codes.join(", ")))
        .collect();
    each.join("; ")
}

/// Lines for a comment: the verdict, its reasons, hidden states, disturbances, coefficients that differ between runs, delays.
pub(crate) fn caveats(d: &Discovery) -> Vec<String> {
    let mut lines = vec![format!("verdict: {}", LawVerdict::of(d).as_str())];
    for (target, reason) in verdict::reasons(d) {
        let text = format!("{target}: {}: {}", reason.code, reason.text);
        lines.extend(wrapped(&comment_safe(&text), WIDTH, "  ", "    "));
    }
    let jumps = d.resets.iter();
    let jumps = jumps.map(|r| format!("states jump: {}", r.text(d)));
    for sentence in jumps.chain(d.hidden_sentences()) {
        lines.extend(wrapped(&comment_safe(&sentence), WIDTH, "  ", "    "));
    }
    for sentence in disturbance::sentences(d) {
        let text = format!("{sentence}; runs of these equations leave it out");
        lines.extend(wrapped(&comment_safe(&text), WIDTH, "  ", "    "));
    }
    for e in &d.equations {
        for t in e.terms.iter().filter(|t| !t.runs.is_empty()) {
            let value = |r: &RunCoefficient| format!("{} in {}", r.figure(), r.run);
            let values: Vec<String> = t.runs.iter().map(value).collect();
            let text = format!(
                "{}: the coefficient of {} differs from run to run ({}); here it is their mean",
                d.name(e.target),
                Language(d).term(&t.term),
                values.join(", ")
            );
            lines.extend(wrapped(&comment_safe(&text), WIDTH, "  ", "    "));
        }
    }
    let unit = d.time_unit();
    for (place, variable) in d.variables.iter().enumerate() {
        let delay = d.input_delay(VarId(place as u16));
        if delay != 0.0 {
            let text = format!(
                "{} acts {} {unit} later than it is commanded: the input to give at time t is its value at t - {}",
                plain(&variable.name),
                significant(delay, 6),
                significant(delay, 6)
            );
            lines.extend(wrapped(&text, WIDTH, "  ", "    "));
        }
    }
    for (place, variable) in d.variables.iter().enumerate() {
        let delay = d.sensor_delay(VarId(place as u16));
        if delay != 0.0 {
            let text = format!(
                "the sensor of {} reads {} {unit} late: its reading at time t is of t - {}",
                plain(&variable.name),
                significant(delay, 6),
                significant(delay, 6)
            );
            lines.extend(wrapped(&text, WIDTH, "  ", "    "));
        }
    }
    lines
}

/// The delay of each input in seconds; empty if none is delayed.
pub(crate) fn delays(d: &Discovery, inputs: &[Signal]) -> Vec<f64> {
    let all: Vec<f64> = inputs.iter().map(|s| d.input_delay(s.var)).collect();
    match all.iter().any(|delay| *delay != 0.0) {
        true => all,
        false => Vec::new(),
    }
}

/// A warning for anyone who exports, linearises or runs a doubted result; `None` if the result passes.
pub fn doubted(d: &Discovery) -> Option<String> {
    let why = Some(codes(d)).filter(|codes| !codes.is_empty());
    let why = why.unwrap_or_else(|| "no reason given".into());
    match LawVerdict::of(d) {
        LawVerdict::Passes => None,
        LawVerdict::Doubted => Some(format!(
            "the equations are doubted ({why}); `sidc report` says why"
        )),
        LawVerdict::Failed => Some(format!("not every equation was found ({why})")),
    }
}

/// The constants of a Python module: the verdict, and the delays if there are any.
pub(crate) fn python_constants(d: &Discovery, inputs: &[Signal]) -> String {
    let mut out = format!("SIDC_VERDICT = \"{}\"\n", verdict_summary(d));
    let delays = delays(d, inputs);
    if !delays.is_empty() {
        let delays: String = delays.iter().map(|t| format!("{t:?}, ")).collect();
        out.push_str(&format!("SIDC_INPUT_DELAYS = ({})\n", delays.trim_end()));
    }
    out
}
