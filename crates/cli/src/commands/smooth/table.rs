//! Smoothed signals as a CSV table.

use crate::outputs::csv::{number, quoted};
use sidc_data::{Dataset, Smoothed, Trajectory};
use sidc_lang::model::{Model, VarKind};
use sidc_lang::number::significant;
use sidc_lang::term::{Signal, SignalNames};

/// A measured signal of one trajectory; `None` if it is not smoothed: inputs, parameters, very short records.
pub struct Curve {
    pub signal: Signal,
    pub smoothed: Option<Smoothed>,
}

/// The columns are `t`, then every signal with its standard error, followed by its derivatives that were not measured.
pub fn csv(model: &Model, dataset: &Dataset, curves: &[Vec<Curve>]) -> String {
    let mut columns: Vec<Column> = Vec::new();
    for curve in curves.iter().flatten() {
        for column in columns_of(model, curve.signal, curves) {
            if !columns.contains(&column) {
                columns.push(column);
            }
        }
    }
    let mut text = String::new();
    let several = dataset.trajectories.len() > 1;
    if several {
        text.push_str("run,");
    }
    text.push('t');
    for c in &columns {
        let name = model.name(c.signal);
        text.push_str(&format!(",{name}"));
        if c.smooth {
            text.push_str(&format!(",{name}_error"));
        }
    }
    text.push('\n');
    for (trajectory, curves) in dataset.trajectories.iter().zip(curves) {
        let parts: Vec<Part> = columns
            .iter()
            .map(|c| Part::new(c, trajectory, curves))
            .collect();
        for (row, t) in trajectory.time.iter().enumerate() {
            if several {
                text.push_str(&format!("{},", quoted(&trajectory.name)));
            }
            text.push_str(&number(Some(t)));
            for (column, part) in columns.iter().zip(&parts) {
                text.push(',');
                text.push_str(&number(part.values.and_then(|v| v.get(row))));
                if column.smooth {
                    text.push(',');
                    let error = part.error.and_then(|v| v.get(row));
                    text.push_str(&error.map_or_else(String::new, |e| significant(*e, 4)));
                }
            }
            text.push('\n');
        }
    }
    text
}

/// One signal of the table. `from` is the measured signal that it is, or is a derivative of.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Column {
    signal: Signal,
    from: Signal,
    smooth: bool,
}

/// A signal and those of its next two derivatives that the model has and that were not measured.
fn columns_of(model: &Model, from: Signal, curves: &[Vec<Curve>]) -> Vec<Column> {
    let Some(var) = model.var(from.var) else {
        return Vec::new();
    };
    let smooth = matches!(var.kind, VarKind::State | VarKind::Output);
    let derivatives = if smooth { 0..=2 } else { 0..=0 };
    let measured = |s: Signal| curves.iter().flatten().any(|c| c.signal == s);
    derivatives
        .map(|d| Signal {
            der: from.der + d,
            ..from
        })
        .take_while(|s| *s == from || (s.der <= var.order && !measured(*s)))
        .map(|signal| Column {
            signal,
            from,
            smooth,
        })
        .collect()
}

/// One trajectory's part of a column.
struct Part<'a> {
    values: Option<&'a [f64]>,
    error: Option<&'a [f64]>,
}

impl<'a> Part<'a> {
    fn new(column: &Column, trajectory: &'a Trajectory, curves: &'a [Curve]) -> Self {
        let curve = curves.iter().find(|c| c.signal == column.from);
        let d = column.signal.der - column.from.der;
        match curve.and_then(|c| c.smoothed.as_ref()) {
            Some(s) => Part {
                values: [&s.values, &s.slope, &s.curvature]
                    .get(usize::from(d))
                    .map(|v| v.as_slice()),
                error: s.error.get(usize::from(d)).map(Vec::as_slice),
            },
            None => Part {
                values: trajectory.column(column.signal),
                error: None,
            },
        }
    }
}
