//! Experiments that stand side by side in one table: the same signals in several sets of columns, `u = "uEst", "uVal"`.
//!
//! In: a model, a table, which of the experiments. Out: its name and its rows. The columns of a shorter experiment end in empty cells.

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::{Model, VarKind};
use sidc_lang::term::Signal;

use super::column_sources::{Source, evaluate, first_header};
use crate::csv::Table;

/// The name of a run: its file and the first column that only this run reads, that of a state if there is one.
pub(super) fn name(model: &Model, run: usize, file: &str) -> String {
    let entries = || model.data.entries.iter().filter(|e| !e.beside.is_empty());
    let of_state = |s: Signal| model.var(s.var).is_some_and(|v| v.kind == VarKind::State);
    let state = entries().find(|e| of_state(e.signal));
    let header = state
        .or_else(|| entries().next())
        .and_then(|e| first_header(e.source_of(run)?));
    match header {
        Some(header) => format!("{file} ({header})"),
        None => format!("{file} ({})", run + 1),
    }
}

/// Leaves out the rows before and after an experiment, in which no signal of its own has a value.
pub(super) fn trim(
    model: &Model,
    table: &Table,
    found: &[(Signal, Source)],
    rows: &mut Vec<usize>,
) {
    let own = |s: Signal| {
        let mut entries = model.data.entries.iter();
        entries.any(|e| e.signal == s && !e.beside.is_empty())
    };
    let columns: Vec<Vec<f64>> = (found.iter())
        .filter(|(s, _)| own(*s))
        .map(|(_, source)| evaluate(*source, table, rows))
        .collect();
    let read = |k: &usize| {
        columns
            .iter()
            .any(|c| c.get(*k).is_some_and(|x| x.is_finite()))
    };
    let first = (0..rows.len()).find(read);
    let last = (0..rows.len()).rev().find(read);
    if let (Some(first), Some(last)) = (first, last) {
        rows.truncate(last + 1);
        rows.drain(..first);
    }
}

/// Faults of a table are found once for each experiment in it; keeps one of each.
pub(super) fn say_once(found: &mut Vec<Diagnostic>) {
    let mut said: Vec<(&'static str, String)> = Vec::new();
    found.retain(|d| {
        let this = (d.code, d.message.clone());
        let new = !said.contains(&this);
        if new {
            said.push(this);
        }
        new
    });
}
