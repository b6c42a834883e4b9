//! What the data lack, and the line that would supply it: the constructors of the diagnostics of binding.

use sidc_lang::diagnostic::{Diagnostic, did_you_mean};
use sidc_lang::model::{Model, RightSide, Var, VarKind};
use sidc_lang::source::{Sources, Span};
use sidc_lang::term::{Expr, Signal, SignalNames};
use sidc_lang::words::beginning;

use crate::csv::Table;
use crate::dataset::BoundTrajectory;

use super::column_sources::{self, Source};

/// A data block entry names a column that the file lacks.
pub(super) fn column(
    model: &Model,
    table: &Table,
    signal: Signal,
    name: Span,
    header: &str,
    at: Span,
) -> Diagnostic {
    let d = Diagnostic::error(
        "missing-column",
        format!("{} has no column \"{header}\"", table.name),
    )
    .at(at, "no such header")
    .also(name, format!("{} is to come from it", model.name(signal)))
    .fact(found(table));
    match likely_header(header, table) {
        Some(h) => d.help(format!("did you mean \"{h}\"?")),
        None => d.help("headers are matched exactly, upper and lower case too"),
    }
}

/// Nothing provides a signal that the equations need.
pub(super) fn signal(model: &Model, table: &Table, signal: Signal, var: &Var) -> Diagnostic {
    let name = model.name(Signal::new(signal.var));
    let what = match var.kind {
        VarKind::Input => "input",
        VarKind::Output => "output",
        VarKind::Param => "parameter",
        VarKind::Unknown => "unknown constant",
        _ => "state",
    };
    let mut d = Diagnostic::error(
        "missing-signal",
        format!("{} lacks a column for the {what} {name}", table.name),
    );
    if let Some(span) = var.span {
        d = d.at(span, "declared here, measured nowhere");
    }
    d = d.fact(found(table));
    if let Some((header, line)) = likely_entry(&name, table) {
        return d
            .fact(format!("\"{header}\" looks like it"))
            .help(format!("data {{ {line} }}"));
    }
    if let Some(target) = rate_of(model, signal) {
        let moved = model.name(Signal::new(target.var));
        let order = target.der + 1;
        let (rate, next) = (model.name(target), Signal::derivative(target.var, order));
        return d.fact(format!("{name} is what {rate} is")).help(format!(
            "a rate of what is measured needs no column: state {moved} : order {order}, then {} for d{name} and {rate} for {name}",
            model.name(next)
        ));
    }
    d.help(match var.kind {
        VarKind::Param => format!("--param {name}=VALUE, one for each trajectory or one for all"),
        _ => format!("data {{ {name} = \"HEADER\" }} with the header of its column"),
    })
}

/// Unknown constants that a column of the table is named after, which nothing would read.
pub(super) fn unknown_columns(
    model: &Model,
    table: &Table,
    found: &[(Signal, Source)],
    sources: &mut Sources,
) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for var in model.unknowns.iter().filter_map(|u| model.var(u.var)) {
        let Some(column) = table.position(&var.name) else {
            continue;
        };
        let known = |s: &Signal| model.var(s.var).is_some_and(|v| v.kind != VarKind::Unknown);
        let mut others = found.iter().filter(|(s, _)| known(s));
        if others.any(|(_, source)| column_sources::used(*source, table).contains(&column)) {
            continue;
        }
        let name = &var.name;
        let text = format!(
            "{name} is an unknown constant, and {} has a column of that name",
            table.name
        );
        let d = Diagnostic::error("unknown-in-data", text);
        let header = table.header_span(sources, column);
        let d = d.at(header, "would not be read");
        let d = match var.span {
            Some(span) => d.also(span, "declared here"),
            None => d,
        };
        out.push(d.help(format!(
            "write `param {name}` for `unknown {name}` if the column has its values; give the constant another name if it has not"
        )));
    }
    out
}

/// Columns named after hidden states: they may be there, for comparison, and are not read.
pub(super) fn hidden_columns(
    model: &Model,
    table: &Table,
    sources: &mut Sources,
) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for (_, var) in model.hidden_states() {
        let Some(column) = table.position(&var.name) else {
            continue;
        };
        let name = &var.name;
        let text = format!("{name} is hidden: its column in {} is not read", table.name);
        let d = Diagnostic::note("hidden-in-data", text);
        let header = table.header_span(sources, column);
        out.push(
            d.at(header, "not read")
                .help(format!("remove `hidden` if it is a measurement of {name}")),
        );
    }
    out
}

/// The signal whose rate this one is, by an equation of the model: x for v in `dx = v`.
fn rate_of(model: &Model, signal: Signal) -> Option<Signal> {
    let says = |right: &RightSide| match right {
        RightSide::Known(e) => *e == Expr::signal(signal),
        RightSide::Search { .. } => false,
    };
    let stated = model.equations.iter().find(|e| says(&e.right))?;
    Some(stated.target).filter(|t| !model.discrete && t.der > 0)
}

/// Continuous time, and no times.
pub(super) fn time(model: &Model, table: &Table) -> Diagnostic {
    let d = Diagnostic::error(
        "missing-time",
        format!(
            "{} has no time column `t`, and the model gives no `step`",
            table.name
        ),
    )
    .fact(found(table));
    let d = match model.data.span {
        Some(span) => d.at(span, "names neither `t` nor `step`"),
        None => d,
    };
    if let Some((header, line)) = likely_entry("t", table) {
        return d
            .fact(format!("\"{header}\" looks like it"))
            .help(format!("data {{ {line} }}"));
    }
    d.help("data { step 0.01 } with the sampling interval in seconds, or data { t = \"HEADER\" }")
}

/// `run = "…"` names no column.
pub(super) fn run(table: &Table, header: &str, at: Span) -> Diagnostic {
    let d = Diagnostic::error(
        "missing-column",
        format!("{} has no column \"{header}\"", table.name),
    )
    .at(at, "to split the file into trajectories")
    .fact(found(table));
    match likely_header(header, table) {
        Some(h) => d.help(format!("did you mean \"{h}\"?")),
        None => d,
    }
}

pub(super) fn run_id(table: &Table, row: usize, at: Span) -> Diagnostic {
    Diagnostic::error(
        "missing-run",
        format!(
            "{}, row {}: which run does this row belong to?",
            table.name,
            row + 1
        ),
    )
    .at(at, "empty")
    .help("write the run's id, or delete the row")
}

pub(super) fn times(name: &str, count: usize, first: Span) -> Diagnostic {
    let s = if count == 1 { " has" } else { "s have" };
    Diagnostic::warning(
        "missing-times",
        format!("{name}: {count} row{s} no time and are left out"),
    )
    .at(first, "the first one")
}

pub(super) fn unknown_param(model: &Model, name: &str) -> Diagnostic {
    let names: Vec<&str> = model
        .vars_of(VarKind::Param)
        .map(|(_, v)| v.name.as_str())
        .collect();
    let d = Diagnostic::error(
        "unknown-param",
        format!("--param {name}: the model declares no parameter of this name"),
    );
    if names.is_empty() {
        return d.help(format!("declare it: param {name}"));
    }
    let d = d.fact(format!("parameters: {}", names.join(", ")));
    match did_you_mean(name, names.iter().copied()) {
        Some(near) => d.help(format!("did you mean {near}?")),
        None => d,
    }
}

pub(super) fn param_twice(name: &str) -> Diagnostic {
    Diagnostic::error(
        "given-twice",
        format!("--param {name}: this has a value already"),
    )
    .help(format!(
        "one value for all trajectories, or one for each: --param {name}=0.3,0.5"
    ))
}

pub(super) fn param_count(name: &str, values: usize, bound: &[BoundTrajectory]) -> Diagnostic {
    let names: Vec<&str> = bound
        .iter()
        .take(8)
        .map(|p| p.trajectory.name.as_str())
        .collect();
    Diagnostic::error(
        "param-count",
        format!(
            "--param {name} gives {values} values for {} trajectories",
            bound.len()
        ),
    )
    .fact(format!("trajectories in order: {}", names.join(", ")))
    .help("give one value for each trajectory, or one for all")
}

fn found(table: &Table) -> String {
    const MAX_HEADERS_SHOWN: usize = 12;
    let named: Vec<String> = table
        .known_headers()
        .filter(|h| !h.is_empty())
        .map(|h| format!("\"{h}\""))
        .collect();
    format!("columns found: {}", beginning(&named, MAX_HEADERS_SHOWN))
}

fn likely_header<'a>(header: &str, table: &'a Table) -> Option<&'a str> {
    let wanted = normalised(header);
    let headers = || {
        table
            .known_headers()
            .map(|h| h.as_str())
            .filter(|h| !h.is_empty())
    };
    headers()
        .find(|h| !wanted.is_empty() && normalised(h) == wanted)
        .or_else(|| did_you_mean(header, headers()))
}

/// A column that may be meant by a signal's name, and the data block line that says so.
fn likely_entry(name: &str, table: &Table) -> Option<(String, String)> {
    let wanted = normalised(name);
    let aliases: &[&str] = match name {
        "t" => &["time", "times", "timestamp", "seconds", "sec", "zeit"],
        _ => &[],
    };
    let alike = |h: &&String| {
        let h = normalised(h);
        !h.is_empty() && (h == wanted || aliases.contains(&h.as_str()))
    };
    let named = || table.known_headers().filter(|h| !h.is_empty());
    let header = named().find(alike).cloned().or_else(|| {
        // A name of one letter is near every other one.
        let long = name.chars().count() > 2;
        let near = did_you_mean(name, named().map(|h| h.as_str()).filter(|_| long));
        near.map(str::to_string)
    })?;
    let scale = unit_factor(&header).map_or(String::new(), |f| format!(" {f}"));
    let line = format!("{name} = \"{header}\"{scale}");
    Some((header, line))
}

/// A header without case, unit and punctuation, with Greek letters spelt out.
fn normalised(header: &str) -> String {
    let bare = header.split(['[', '(']).next().unwrap_or("");
    let mut out = String::new();
    for c in bare.chars().flat_map(char::to_lowercase) {
        match GREEK.iter().find(|(g, _)| *g == c) {
            Some((_, name)) => out.push_str(name),
            None if c.is_alphanumeric() => out.push(c),
            None => {}
        }
    }
    out
}

const GREEK: [(char, &str); 14] = [
    ('α', "alpha"),
    ('β', "beta"),
    ('γ', "gamma"),
    ('δ', "delta"),
    ('ε', "epsilon"),
    ('θ', "theta"),
    ('κ', "kappa"),
    ('λ', "lambda"),
    ('μ', "mu"),
    ('ρ', "rho"),
    ('τ', "tau"),
    ('φ', "phi"),
    ('ψ', "psi"),
    ('ω', "omega"),
];

/// The arithmetic that takes a header's unit, in brackets, to SI.
fn unit_factor(header: &str) -> Option<&'static str> {
    let (_, rest) = header.split_once(['[', '('])?;
    let unit = rest.split([']', ')']).next()?.trim();
    Some(match unit {
        "ms" | "mm" | "mm/s" | "mV" | "mA" => "* 1e-3",
        "us" | "µs" | "μs" | "um" | "µm" | "μm" => "* 1e-6",
        "ns" | "nm" => "* 1e-9",
        "cm" | "cm/s" => "* 1e-2",
        "km" | "kN" | "kV" => "* 1e3",
        "min" => "* 60",
        "h" => "* 3600",
        "deg" | "°" | "deg/s" | "°/s" | "degrees" => "* pi/180",
        "rpm" => "* 2*pi/60",
        "%" => "/ 100",
        _ => return None,
    })
}
