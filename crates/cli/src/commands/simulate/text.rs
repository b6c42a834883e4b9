//! Free runs as readable text.

use crate::thresholds::LISTS;
use sidc_emit as emit;
use sidc_lang::number::significant;
use sidc_lang::term::SignalNames;
use sidc_system::discovery::Discovery;
use sidc_system::simulate::{Fault, Leg, Options, Origin, Run, Score, Start};

/// The start, the end and the scores of each run.
pub fn describe(d: &Discovery, runs: &[Run], options: &Options) -> String {
    let mut out = String::new();
    for (i, run) in runs.iter().enumerate() {
        if i > 0 {
            out.push('\n');
        }
        out.push_str(&heading(d, run, options));
        let several = run.legs.len() > 1;
        for (k, leg) in run.legs.iter().enumerate() {
            if several && k >= LISTS.starts {
                let more = run.legs.len() - LISTS.starts;
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

fn heading(d: &Discovery, run: &Run, options: &Options) -> String {
    let system = d.system.as_deref().unwrap_or("system");
    let rows: usize = run.legs.iter().map(|l| l.rows.len()).sum();
    let how = match options.step {
        _ if d.discrete => String::new(),
        Some(h) => format!(", fixed steps of at most {h} {}", d.time_unit()),
        None => run.work.stiff_from.map_or_else(String::new, |t| {
            format!(", stiff from t = {} on", significant(t, 6))
        }),
    };
    let name = &run.name;
    let constants = emit::constants_in(d, name).into_iter();
    let constants: String = constants
        .flat_map(|line| emit::wrapped(&line, emit::TEXT_WIDTH, "    ", "        "))
        .map(|line| format!("{line}\n"))
        .collect();
    format!("{system}: free run along {name}, {rows} rows{how}\n{constants}")
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
        Origin::Hidden => "hidden: its mean over the data used".into(),
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
        Some(t) => format!("{} {}", significant(t, 3), d.time_unit()),
    }
}

/// A number with this many decimals, or in scientific notation if it is very large.
fn decimal(x: f64, decimals: usize) -> String {
    match x {
        _ if x.is_nan() => "–".into(),
        _ if x == f64::INFINITY => "∞".into(),
        _ if x == f64::NEG_INFINITY => "-∞".into(),
        _ if x.abs() >= 1e6 => significant(x, 3),
        _ => format!("{x:.decimals$}"),
    }
}

/// Aligned columns, indented by four spaces and separated by two.
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
