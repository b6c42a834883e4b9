//! Errors in entries of the data block.
//!
//! Constructors only: places and values in, diagnostics out.

use crate::diagnostic::{Diagnostic, Edit};
use crate::source::Span;

pub fn step(at: Span, value: f64) -> Diagnostic {
    Diagnostic::error(
        "data-entry",
        format!("a step of {value} is no sampling interval"),
    )
    .at(at, "a number of seconds above 0")
    .help("write `step 0.01`")
    .fix(at, "0.01")
}

/// `header` is the text found, without quotes.
pub fn run(at: Span, header: &str) -> Diagnostic {
    Diagnostic::error(
        "data-entry",
        "`run` names the column that splits a file into trajectories",
    )
    .at(at, "not one quoted header")
    .help(format!("write `run = \"{header}\"`"))
    .fix(at, format!("\"{header}\""))
}

/// Two signals with different numbers of sources, each given by place, name and count. `sources` is the place of the wrong sources and the
/// text of the first.
pub fn sources_differ(
    (at, name, count): (Span, String, usize),
    (first, other, expected): (Span, String, usize),
    sources: (Span, &str),
) -> Diagnostic {
    Diagnostic::error(
        "data-entry",
        format!("`{name}` has {count} sources, and `{other}` has {expected}"),
    )
    .at(at, format!("{count} runs"))
    .also(first, format!("{expected} runs"))
    .help("give one source for each run, in the same order, or a single one that all runs read")
    .fix(sources.0, sources.1)
}

/// Experiments side by side, together with a column of runs.
pub fn side_by_side_with_run_column(at: Span, run: Span) -> Diagnostic {
    Diagnostic::error(
        "data-entry",
        "experiments stand side by side or below each other, not both",
    )
    .at(at, "one source for each run: side by side")
    .also(run, "a column of runs: below each other")
    .help("leave out `run`, or read each signal from one column")
    .remove(run)
}

/// `whole` is the place of the sources of all runs.
pub fn nothing_in_one_run(at: Span, whole: Span) -> Diagnostic {
    Diagnostic::error("data-entry", "`none` stands alone")
        .at(at, "a source of one run among several")
        .help("write the column of this run, or `none` for all runs")
        .fix(whole, "none")
}

pub fn data_for_let(at: Span, name: &str, definition: Span) -> Diagnostic {
    Diagnostic::error(
        "data-entry",
        format!("`{name}` is defined by `let` and takes no data"),
    )
    .at(at, "no signal")
    .also(definition, "defined here")
    .help(format!("declare it: `param {name}`"))
    .edit(Edit::Redeclare(definition, "param"))
}

pub fn library_in_data(at: Span) -> Diagnostic {
    Diagnostic::error("data-entry", "a data entry is arithmetic on columns")
        .at(at, "a library or a range")
        .help("write `x = \"Column\" * 1e-3`")
}

pub fn unquoted_column(at: Span, text: &str) -> Diagnostic {
    Diagnostic::error("unquoted-column", format!("`{text}` is no number"))
        .at(at, "columns stand in quotes")
        .help(format!("write `\"{text}\"` for the column of that name"))
        .fix(at, format!("\"{text}\""))
}

pub fn period(at: Span, value: f64) -> Diagnostic {
    Diagnostic::error("data-entry", format!("a period of {value} does not exist"))
        .at(at, "a number above 0")
        .help("write `unwrap(\"Angle\", 2*pi)`, or 360 for degrees")
        .fix(at, "2*pi")
        .fix(at, "360")
}
