//! The source of each signal in one table: its entry in the data block, else the column of its name.
//!
//! In: a model and a table. Out: column expressions and their values. Reports nothing itself.

use std::borrow::Cow;
use std::collections::BTreeSet;

use sidc_lang::model::{ColumnExpr, ColumnKind, LibExpr, LibKind, Model, RightSide, Var, VarKind};
use sidc_lang::source::Span;
use sidc_lang::term::{Signal, SignalNames};

use crate::csv::Table;
use crate::series::select;

/// Where one signal's values come from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source<'a> {
    /// An entry of the data block: the name's place, and the expression.
    Entry(&'a ColumnExpr, Span),
    /// The column of the signal's own name.
    Column(usize),
}

/// Every signal that the table or the data block provides to one of the runs that stand side by side, sorted; time included.
pub(super) fn sources_of<'a>(
    model: &'a Model,
    table: &Table,
    run: usize,
) -> Vec<(Signal, Source<'a>)> {
    let mut out = Vec::new();
    let read = |var: &(usize, &Var)| var.1.kind != VarKind::Unknown && !var.1.hidden;
    for (i, var) in model.vars.iter().enumerate().filter(read) {
        let id = sidc_lang::term::VarId(i as u16);
        for der in 0..=var.order {
            let signal = Signal::derivative(id, der);
            match model.data.entries.iter().find(|e| e.signal == signal) {
                Some(entry) => {
                    if let Some(e) = entry.source_of(run) {
                        out.push((signal, Source::Entry(e, entry.span)));
                    }
                }
                None => {
                    if let Some(column) = table.position(&model.name(signal)) {
                        out.push((signal, Source::Column(column)));
                    }
                }
            }
        }
    }
    out
}

/// The headers of every column that a model can read: of its signals, and what its data block names.
pub(super) fn headers(model: &Model) -> BTreeSet<String> {
    let mut out = BTreeSet::new();
    for (i, var) in model.vars.iter().enumerate() {
        let id = sidc_lang::term::VarId(i as u16);
        let signals = (0..=var.order).map(|der| Signal::derivative(id, der));
        out.extend(signals.map(|signal| model.name(signal)));
    }
    for entry in &model.data.entries {
        for source in entry.source.iter().chain(&entry.beside) {
            for_each_column(source, &mut |header, _| {
                out.insert(header.to_string());
            });
        }
    }
    out.extend(model.data.run.iter().map(|(header, _)| header.clone()));
    out
}

/// Headers of columns that rise and fall and that no signal reads, each once. Columns that only rise are left out, since they are
/// clocks or row numbers; of logs, also columns that were not asked for.
pub(super) fn unread(model: &Model, tables: &[Cow<Table>]) -> Vec<String> {
    let mut known = headers(model);
    let mut out = Vec::new();
    for table in tables {
        for (column, header) in table.headers().iter().enumerate() {
            let new = !header.is_empty() && !known.contains(header);
            if new && moves_up_and_down(table.values(column)) {
                known.insert(header.clone());
                out.push(header.clone());
            }
        }
    }
    out
}

fn moves_up_and_down(values: &[f64]) -> bool {
    let mut steps = values.iter().zip(values.iter().skip(1));
    let falls = steps.clone().any(|(a, b)| b < a);
    falls && steps.any(|(a, b)| b > a)
}

/// Signals that the equations mention, targets included, sorted.
pub(super) fn mentioned(model: &Model) -> BTreeSet<Signal> {
    let mut out = BTreeSet::new();
    for equation in &model.equations {
        out.insert(equation.target);
        match &equation.right {
            RightSide::Known(e) => e.for_each_signal(&mut |s| {
                out.insert(s);
            }),
            RightSide::Search { known, library } => {
                for (e, _) in known {
                    e.for_each_signal(&mut |s| {
                        out.insert(s);
                    });
                }
                if let Some(lib) = library {
                    library_signals(lib, &mut out);
                }
            }
        }
    }
    out
}

fn library_signals(lib: &LibExpr, out: &mut BTreeSet<Signal>) {
    match &lib.kind {
        LibKind::Term(e) => e.for_each_signal(&mut |s| {
            out.insert(s);
        }),
        LibKind::List(items) => items.iter().for_each(|l| library_signals(l, out)),
        LibKind::Union(a, b)
        | LibKind::Difference(a, b)
        | LibKind::Product(a, b)
        | LibKind::Quotient(a, b) => {
            library_signals(a, out);
            library_signals(b, out);
        }
        LibKind::Power(a, _) => library_signals(a, out),
        LibKind::Generate { args, .. } => args.iter().for_each(|l| library_signals(l, out)),
        LibKind::Named { body, .. } | LibKind::Required(body) => library_signals(body, out),
    }
}

/// The lowest derivative of each mentioned variable; it, or a lower one, must be measured. Time is not listed.
pub(super) fn required(model: &Model) -> Vec<Signal> {
    let mut out: Vec<Signal> = Vec::new();
    for s in mentioned(model) {
        let kind = model.var(s.var).map(|v| v.kind);
        let read = !matches!(kind, None | Some(VarKind::Time | VarKind::Unknown))
            && !model.is_hidden(s.var);
        if read && out.last().is_none_or(|last| last.var != s.var) {
            out.push(Signal::derivative(s.var, s.der));
        }
    }
    out
}

/// Headers that an expression names but the table lacks, with their places.
pub(super) fn absent<'a>(e: &'a ColumnExpr, table: &Table, out: &mut Vec<(&'a str, Span)>) {
    for_each_column(e, &mut |header, span| {
        if table.position(header).is_none() {
            out.push((header, span));
        }
    });
}

/// Columns of the table that a source reads.
pub(super) fn used(source: Source, table: &Table) -> Vec<usize> {
    match source {
        Source::Column(c) => vec![c],
        Source::Entry(e, _) => {
            let mut out = Vec::new();
            for_each_column(e, &mut |header, _| out.extend(table.position(header)));
            out
        }
    }
}

fn for_each_column<'a>(e: &'a ColumnExpr, visit: &mut impl FnMut(&'a str, Span)) {
    match &e.kind {
        ColumnKind::Number(_) => {}
        ColumnKind::Column(header) => visit(header, e.span),
        ColumnKind::Negate(a) | ColumnKind::Power(a, _) | ColumnKind::Unwrap(a, _) => {
            for_each_column(a, visit);
        }
        ColumnKind::Add(a, b)
        | ColumnKind::Subtract(a, b)
        | ColumnKind::Multiply(a, b)
        | ColumnKind::Divide(a, b) => {
            for_each_column(a, visit);
            for_each_column(b, visit);
        }
        ColumnKind::Call(_, args) => args.iter().for_each(|a| for_each_column(a, visit)),
    }
}

/// The first header that an expression names.
pub(super) fn first_header(e: &ColumnExpr) -> Option<&str> {
    let mut first = None;
    for_each_column(e, &mut |header, _| first = first.or(Some(header)));
    first
}

/// Values of a source at the given rows of a table; NaN where a cell is missing.
pub(super) fn evaluate(source: Source, table: &Table, rows: &[usize]) -> Vec<f64> {
    match source {
        Source::Column(c) => select(table.values(c), rows),
        Source::Entry(e, _) => value(e, table, rows),
    }
}

fn value(e: &ColumnExpr, table: &Table, rows: &[usize]) -> Vec<f64> {
    let one = |a: &ColumnExpr, f: &dyn Fn(f64) -> f64| -> Vec<f64> {
        value(a, table, rows).into_iter().map(f).collect()
    };
    let two = |a: &ColumnExpr, b: &ColumnExpr, f: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        let (a, b) = (value(a, table, rows), value(b, table, rows));
        a.into_iter().zip(b).map(|(a, b)| f(a, b)).collect()
    };
    match &e.kind {
        ColumnKind::Number(x) => vec![*x; rows.len()],
        ColumnKind::Column(header) => match table.position(header) {
            Some(c) => select(table.values(c), rows),
            None => vec![f64::NAN; rows.len()],
        },
        ColumnKind::Negate(a) => one(a, &|a| -a),
        ColumnKind::Add(a, b) => two(a, b, &|a, b| a + b),
        ColumnKind::Subtract(a, b) => two(a, b, &|a, b| a - b),
        ColumnKind::Multiply(a, b) => two(a, b, &|a, b| a * b),
        ColumnKind::Divide(a, b) => two(a, b, &|a, b| a / b),
        ColumnKind::Power(a, p) => one(a, &|a| {
            sidc_lang::term::Expr::number(a).pow(*p).eval(&|_| 0.0)
        }),
        ColumnKind::Unwrap(a, period) => unwrap(&value(a, table, rows), *period),
        ColumnKind::Call(f, args) => {
            let args: Vec<Vec<f64>> = args.iter().map(|a| value(a, table, rows)).collect();
            let at = |row: usize| -> Vec<f64> {
                args.iter()
                    .map(|a| a.get(row).copied().unwrap_or(f64::NAN))
                    .collect()
            };
            (0..rows.len())
                .map(|row| {
                    let xs = at(row);
                    // min and max of f64 would hide a missing value.
                    if xs.iter().any(|x| x.is_nan()) {
                        f64::NAN
                    } else {
                        (f.eval)(&xs)
                    }
                })
                .collect()
        }
    }
}

/// Phase unwrapping: removes jumps of more than half a period, across missing values too.
fn unwrap(values: &[f64], period: f64) -> Vec<f64> {
    let mut last: Option<f64> = None;
    let mut turns = 0.0;
    values
        .iter()
        .map(|&x| {
            if let Some(before) = last.filter(|_| x.is_finite()) {
                turns -= ((x - before) / period).round();
            }
            if x.is_finite() {
                last = Some(x);
            }
            x + turns * period
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unwrapping_undoes_turns_and_steps_over_gaps() {
        let wrapped = [3.0, 3.1, -3.1, f64::NAN, -3.0, 3.1];
        let tau = std::f64::consts::TAU;
        let got = unwrap(&wrapped, tau);
        let want = [3.0, 3.1, tau - 3.1, f64::NAN, tau - 3.0, 3.1];
        for (g, w) in got.iter().zip(want) {
            assert!((g - w).abs() < 1e-12 || g.is_nan() && w.is_nan(), "{got:?}");
        }
    }
}
