//! Free runs as JSON.

use serde::Serialize;

use crate::failure::Failure;
use sidc_lang::diagnostic::{Diagnostic, Severity};
use sidc_lang::term::SignalNames;
use sidc_system::discovery::Discovery;
use sidc_system::simulate::{Figures, Leg, Origin, Run, Start};

#[derive(Serialize)]
struct Document<'a> {
    sidc_simulation: u32,
    result: &'a str,
    runs: Vec<RunEntry<'a>>,
}

#[derive(Serialize)]
struct RunEntry<'a> {
    trajectory: &'a str,
    rows: usize,
    evaluations: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    stiff_from: Option<f64>,
    legs: Vec<LegEntry>,
    scores: Vec<Figures>,
    notes: Vec<NoteEntry<'a>>,
}

#[derive(Serialize)]
struct LegEntry {
    from: Option<f64>,
    to: Option<f64>,
    rows: usize,
    /// Rows that the start was fitted to; they are not scored.
    settled: usize,
    start: Vec<StartEntry>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ended: Option<FaultEntry>,
}

#[derive(Serialize)]
struct StartEntry {
    signal: String,
    value: f64,
    origin: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    standard_error: Option<f64>,
}

#[derive(Serialize)]
struct FaultEntry {
    code: &'static str,
    text: String,
    time: f64,
    equations: Vec<String>,
    state: Vec<(String, f64)>,
}

#[derive(Serialize)]
struct NoteEntry<'a> {
    code: &'a str,
    severity: &'static str,
    text: &'a str,
}

/// The runs as JSON, ending in a newline.
pub fn json(d: &Discovery, result: &str, runs: &[Run]) -> Result<String, Failure> {
    let document = Document {
        sidc_simulation: 1,
        result,
        runs: runs.iter().map(|r| run_entry(d, r)).collect(),
    };
    serde_json::to_string_pretty(&document)
        .map(|text| text + "\n")
        .map_err(Failure::internal)
}

fn run_entry<'a>(d: &Discovery, run: &'a Run) -> RunEntry<'a> {
    let note = |n: &'a Diagnostic| NoteEntry {
        code: n.code,
        severity: match n.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        },
        text: &n.message,
    };
    RunEntry {
        trajectory: &run.name,
        rows: run.legs.iter().map(|l| l.rows.len()).sum(),
        evaluations: run.work.evaluations,
        stiff_from: run.work.stiff_from,
        legs: run.legs.iter().map(|l| leg_entry(d, run, l)).collect(),
        scores: run.scores.iter().map(|s| Figures::of(d, s)).collect(),
        notes: run.notes.iter().map(note).collect(),
    }
}

fn leg_entry(d: &Discovery, run: &Run, leg: &Leg) -> LegEntry {
    let start = |s: &Start| StartEntry {
        signal: d.name(s.signal),
        value: s.value,
        origin: match s.origin {
            Origin::Measured => "measured",
            Origin::Given => "given",
            Origin::Differentiated => "differentiated",
            Origin::Smoothed => "smoothed",
            Origin::Hidden => "hidden",
            Origin::Fitted => "fitted",
        },
        standard_error: s.error,
    };
    let time = |row: Option<usize>| row.and_then(|r| run.time.get(r)).copied();
    LegEntry {
        from: time(Some(leg.rows.start)),
        to: time(leg.rows.end.checked_sub(1)),
        rows: leg.rows.len(),
        settled: leg.settled,
        start: leg.start.iter().map(start).collect(),
        ended: leg.fault.as_ref().map(|f| FaultEntry {
            code: f.kind.code(),
            text: f.text(d),
            time: f.time,
            equations: f.equations.iter().map(|s| d.name(*s)).collect(),
            state: f.at.iter().map(|(s, v)| (d.name(*s), *v)).collect(),
        }),
    }
}
