//! Runs as text for people, as JSON, as CSV.

use serde::Serialize;

use super::super::Failure;
use sidc_lang::diagnostic::{Diagnostic, Severity};
use sidc_lang::number::significant;
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::discovery::Discovery;
use sidc_system::simulate::{Fault, Figures, Leg, Options, Origin, Run, Score, Start};

/// What a user reads: for each run its starts, its end, its scores.
pub fn text(d: &Discovery, runs: &[Run], options: &Options) -> String {
    let mut out = String::new();
    for (i, run) in runs.iter().enumerate() {
        if i > 0 {
            out.push('\n');
        }
        out.push_str(&heading(d, run, options));
        let several = run.legs.len() > 1;
        for (k, leg) in run.legs.iter().enumerate() {
            if several && k >= SHOWN {
                let more = run.legs.len() - SHOWN;
                out.push_str(&format!("\nand {more} more starts\n"));
                break;
            }
            out.push_str(&start(d, run, leg));
        }
        if let Some(fault) = run.fault() {
            out.push_str(&format!("\n{}", ended(d, run, fault)));
        }
        out.push_str(&scores(d, run));
    }
    out
}

/// Starts printed of one run.
const SHOWN: usize = 3;

fn heading(d: &Discovery, run: &Run, options: &Options) -> String {
    let system = d.system.as_deref().unwrap_or("system");
    let rows: usize = run.legs.iter().map(|l| l.rows.len()).sum();
    let how = match options.step {
        _ if d.discrete => String::new(),
        Some(h) => format!(", fixed steps of at most {h} s"),
        None => run.work.stiff_from.map_or_else(String::new, |t| {
            format!(", stiff from t = {} on", significant(t, 6))
        }),
    };
    let name = &run.name;
    format!("{system}: free run along {name}, {rows} rows{how}\n")
}

fn start(d: &Discovery, run: &Run, leg: &Leg) -> String {
    let t = run.time.get(leg.rows.start).copied().unwrap_or(0.0);
    let mut rows = Vec::new();
    for s in &leg.start {
        let error = s.error.map_or_else(String::new, |e| {
            format!("standard error {}", significant(e, 2))
        });
        rows.push([
            d.name(s.signal),
            significant(s.value, 6),
            origin(s, leg),
            error,
        ]);
    }
    format!(
        "\nstart at {} = {}\n{}",
        clock(d),
        significant(t, 6),
        aligned(&rows, &[false, true, false, false])
    )
}

fn clock(d: &Discovery) -> &'static str {
    if d.discrete { "sample" } else { "t" }
}

fn origin(s: &Start, leg: &Leg) -> String {
    match s.origin {
        Origin::Measured => "measured".into(),
        Origin::Given => "given".into(),
        Origin::Differentiated => "estimated from clean readings".into(),
        Origin::Smoothed => "smoothed".into(),
        Origin::Fitted => format!("fitted to the first {} rows", leg.settled),
    }
}

fn ended(d: &Discovery, run: &Run, fault: &Fault) -> String {
    let mut text = format!(
        "ended[{}] at {} = {}: {}\n",
        fault.kind.code(),
        clock(d),
        significant(fault.time, 6),
        fault.text(d)
    );
    let values: Vec<String> = fault
        .at
        .iter()
        .map(|(s, v)| format!("{} = {}", d.name(*s), significant(*v, 4)))
        .collect();
    if !values.is_empty() {
        text.push_str(&format!("    there {}\n", values.join(", ")));
    }
    let rows: usize = run.legs.iter().map(|l| l.rows.len()).sum();
    text.push_str(&format!("    kept: {rows} rows\n"));
    text
}

fn scores(d: &Discovery, run: &Run) -> String {
    if run.scores.is_empty() {
        return "\nnothing that is simulated was measured after the start: no scores\n".into();
    }
    let words = [
        "",
        "mean square",
        "mean abs.",
        "error/signal",
        "fit",
        "R²",
        "follows for",
        "rows",
    ];
    let mut rows = vec![words.map(String::from)];
    for s in &run.scores {
        rows.push([
            d.name(s.signal),
            significant(s.mse, 3),
            significant(s.mae, 3),
            format!("{} dB", decimal(s.error_to_signal, 1)),
            format!("{} %", decimal(s.fit, 2)),
            decimal(s.r_squared, 4),
            follows(d, s),
            s.rows.to_string(),
        ]);
    }
    let right = [false, true, true, true, true, true, true, true];
    format!("\n{}", aligned(&rows, &right))
}

fn follows(d: &Discovery, s: &Score) -> String {
    match s.follows {
        None => "all".into(),
        Some(t) if d.discrete => format!("{t} samples"),
        Some(t) => format!("{} s", significant(t, 3)),
    }
}

/// A figure with so many decimals; far off ones in powers of ten.
fn decimal(x: f64, decimals: usize) -> String {
    match x {
        _ if x.is_nan() => "–".into(),
        _ if x == f64::INFINITY => "∞".into(),
        _ if x == f64::NEG_INFINITY => "-∞".into(),
        _ if x.abs() >= 1e6 => significant(x, 3),
        _ => format!("{x:.decimals$}"),
    }
}

/// Columns side by side, four spaces before, two between.
fn aligned<const N: usize>(rows: &[[String; N]], right: &[bool; N]) -> String {
    let width = |c: usize| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    let mut out = String::new();
    for row in rows {
        let mut line = String::from("   ");
        for ((cell, width), right) in row.iter().zip(widths).zip(right) {
            line.push_str(&match right {
                true => format!(" {cell:>width$} "),
                false => format!(" {cell:<width$} "),
            });
        }
        out.push_str(line.trim_end());
        out.push('\n');
    }
    out
}

/// The simulated signals as CSV: `t`, simulated, inputs as applied, measurements with `_measured` behind their names; `run`
/// before them if there are several.
pub fn table(d: &Discovery, runs: &[Run]) -> String {
    let several = runs.len() > 1;
    let mut text = String::from(if several { "run,t" } else { "t" });
    let columns = Columns::of(runs);
    for s in columns.simulated.iter().chain(&columns.inputs) {
        text.push_str(&format!(",{}", d.name(*s)));
    }
    for s in &columns.measured {
        text.push_str(&format!(",{}_measured", d.name(*s)));
    }
    text.push('\n');
    for run in runs {
        let find = |all: &[(Signal, Vec<f64>)], s: &Signal| -> Option<usize> {
            all.iter().position(|(name, _)| name == s)
        };
        let parts = [
            (&run.simulated, &columns.simulated),
            (&run.inputs, &columns.inputs),
            (&run.measured, &columns.measured),
        ];
        let cells = parts.iter().flat_map(|(all, wanted)| {
            wanted
                .iter()
                .map(|s| find(all, s).map(|i| all[i].1.as_slice()))
        });
        let cells: Vec<Option<&[f64]>> = cells.collect();
        for (row, t) in run.time.iter().enumerate() {
            if several {
                text.push_str(&format!("\"{}\",", run.name.replace('"', "'")));
            }
            text.push_str(&number(Some(t)));
            for cell in &cells {
                text.push(',');
                text.push_str(&number(cell.and_then(|c| c.get(row))));
            }
            text.push('\n');
        }
    }
    text
}

/// What any run has a column of.
#[derive(Default)]
struct Columns {
    simulated: Vec<Signal>,
    inputs: Vec<Signal>,
    measured: Vec<Signal>,
}

impl Columns {
    fn of(runs: &[Run]) -> Columns {
        let mut out = Columns::default();
        let add = |to: &mut Vec<Signal>, from: &[(Signal, Vec<f64>)]| {
            for (s, _) in from {
                if !to.contains(s) {
                    to.push(*s);
                }
            }
        };
        for run in runs {
            add(&mut out.simulated, &run.simulated);
            add(&mut out.inputs, &run.inputs);
            add(&mut out.measured, &run.measured);
        }
        out
    }
}

/// As short as it reads back to the same number; nothing for a missing one.
fn number(x: Option<&f64>) -> String {
    match x {
        Some(x) if *x == 0.0 || (1e-4..1e15).contains(&x.abs()) => format!("{x}"),
        Some(x) if x.is_finite() => format!("{x:e}"),
        _ => String::new(),
    }
}

/// What a program reads.
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
    /// Rows that the start was fitted to, and that are not scored.
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
pub fn document(d: &Discovery, result: &str, runs: &[Run]) -> Result<String, Failure> {
    let document = Document {
        sidc_simulation: 1,
        result,
        runs: runs.iter().map(|r| run_entry(d, r)).collect(),
    };
    serde_json::to_string_pretty(&document)
        .map(|text| text + "\n")
        .map_err(|e| Failure::new(format!("error[internal]: {e}; please report this")))
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
