//! Binds tables to a model: which column is which signal, which rows are which trajectory.
//!
//! In: a checked model, tables in the order of the command line, values of parameters. Out: a [`Dataset`] in model units, and
//! everything that is missing or strange about it. Estimates nothing.

mod column_sources;
mod missing_data;
mod side_by_side;

use std::borrow::Cow;

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::{Model, VarKind};
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, VarId};

use crate::checks::{self, sampling_times};
use crate::csv::{Table, bad_cells};
use crate::dataset::BoundTrajectory;
use crate::dataset::{Dataset, Trajectory};
use crate::{intersample, rate_columns, time_axis};

/// Binds tables to a model's signals.
///
/// `params` are `(name, values)` from the command line: one value per trajectory in order, or one for all. The dataset is
/// complete only if no diagnostic is an error. Codes: see docs/diagnostics.md.
pub fn bind(
    model: &Model,
    tables: &[Table],
    params: &[(String, Vec<f64>)],
    sources: &mut Sources,
) -> (Dataset, Vec<Diagnostic>) {
    let mut out = Vec::new();
    let mut bound = Vec::new();
    let tables = asked_of(model, tables, &mut out);
    for (file, table) in tables.iter().enumerate() {
        for run in 0..model.data.side_by_side() {
            let mut of_table = bind_table((model, run), table, params, sources, &mut out);
            of_table.iter_mut().for_each(|p| p.trajectory.file = file);
            bound.extend(of_table);
        }
    }
    if model.data.side_by_side() > 1 {
        side_by_side::say_once(&mut out);
    }
    give_params(model, params, &mut bound, &mut out);
    for one in &mut bound {
        one.trajectory.start_unknowns(model);
    }
    checks::check(model, &bound, sources, &mut out);
    let records = || bound.iter().map(|p| &p.trajectory);
    let mut assumed = Vec::new();
    let inputs = intersample::infer(model, &records().collect::<Vec<_>>(), &mut assumed);
    for one in &mut bound {
        intersample::fill(&inputs, &mut one.trajectory);
    }
    let source = |signal| checks::source_text(model, sources, signal);
    let rate_faults = rate_columns::judge(model, &mut bound, &inputs, &source, &mut out);
    out.extend(assumed);
    let dataset = Dataset {
        trajectories: bound.into_iter().map(|p| p.trajectory).collect(),
        inputs,
        rate_faults,
        unread: column_sources::unread(model, &tables),
    };
    (dataset, out)
}

/// Of logs the columns that the model reads; other tables as they are.
fn asked_of<'a>(
    model: &Model,
    tables: &'a [Table],
    out: &mut Vec<Diagnostic>,
) -> Vec<Cow<'a, Table>> {
    let read = column_sources::headers(model);
    let mut asked = Vec::new();
    for table in tables {
        match table.of_columns(&|header| read.contains(header)) {
            Ok(table) => asked.push(table),
            Err(large) => out.push(large.diagnostic()),
        }
    }
    asked
}

/// The trajectories of a table, or of one of the experiments that stand side by side in it.
fn bind_table<'a>(
    (model, beside): (&Model, usize),
    table: &'a Table,
    params: &[(String, Vec<f64>)],
    sources: &mut Sources,
    out: &mut Vec<Diagnostic>,
) -> Vec<BoundTrajectory<'a>> {
    let found = column_sources::sources_of(model, table, beside);
    let before = out.len();
    for (signal, source) in &found {
        if let column_sources::Source::Entry(e, name) = source {
            let mut absent = Vec::new();
            column_sources::absent(e, table, &mut absent);
            for (header, span) in absent {
                out.push(missing_data::column(
                    model, table, *signal, *name, header, span,
                ));
            }
        }
    }
    for signal in column_sources::required(model) {
        let Some(var) = model.var(signal.var) else {
            continue;
        };
        let given = params.iter().any(|(name, _)| *name == var.name);
        if var.kind == VarKind::Param && given {
            continue;
        }
        let measured = |(s, _): &(Signal, _)| s.var == signal.var && s.der <= signal.der;
        if !found.iter().any(measured) {
            out.push(missing_data::signal(model, table, signal, var));
        }
    }
    out.extend(missing_data::unknown_columns(model, table, &found, sources));
    out.extend(missing_data::hidden_columns(model, table, sources));
    let run = run_column(model, table, out);
    let has_time = found.iter().any(|(s, _)| *s == Signal::TIME);
    if !has_time && !model.discrete && model.data.step.is_none() {
        out.push(missing_data::time(model, table));
    }
    let mut used: Vec<usize> = found
        .iter()
        .flat_map(|(_, s)| column_sources::used(*s, table))
        .collect();
    used.sort_unstable();
    used.dedup();
    out.extend(bad_cells(table, &used, sources));
    if out.iter().skip(before).any(Diagnostic::is_error) {
        return Vec::new();
    }
    let mut runs = split_runs(table, run, sources, out);
    if model.data.side_by_side() > 1 {
        for (name, rows) in &mut runs {
            *name = side_by_side::name(model, beside, name);
            side_by_side::trim(model, table, &found, rows);
        }
    }
    runs.into_iter()
        .filter_map(|(name, rows)| bind_run(model, table, &found, name, rows, sources, out))
        .collect()
}

/// One trajectory; `None` if its times do not rise or no row has a time.
fn bind_run<'a>(
    model: &Model,
    table: &'a Table,
    found: &[(Signal, column_sources::Source)],
    name: String,
    mut rows: Vec<usize>,
    sources: &mut Sources,
    out: &mut Vec<Diagnostic>,
) -> Option<BoundTrajectory<'a>> {
    let clock = found.iter().find(|(s, _)| *s == Signal::TIME);
    let mut time: Option<Vec<f64>> = None;
    let mut uneven = None;
    if let Some((_, source)) = clock {
        let mut values = column_sources::evaluate(*source, table, &rows);
        let column = column_sources::used(*source, table).first().copied();
        let absent = values.iter().filter(|t| !t.is_finite()).count();
        if absent > 0 {
            let first = values.iter().position(|t| !t.is_finite());
            let row = first.and_then(|i| rows.get(i)).copied().unwrap_or(0);
            let span = table.cell_span(sources, row, column.unwrap_or(0));
            out.push(missing_data::times(&name, absent, span));
            let keep: Vec<bool> = values.iter().map(|t| t.is_finite()).collect();
            let mut kept = keep.iter();
            rows.retain(|_| kept.next().copied().unwrap_or(false));
            values.retain(|t| t.is_finite());
        }
        if let Some(d) = sampling_times::falling_time(table, &name, &rows, &values, column, sources)
        {
            out.push(d);
            return None;
        }
        uneven = sampling_times::check_steps(
            (&name, &model.time_unit()),
            &rows,
            &mut values,
            table,
            out,
        );
        time = Some(values);
    }
    if rows.is_empty() {
        return None;
    }
    let mut signals: Vec<(Signal, Vec<f64>)> = found
        .iter()
        .filter(|(s, _)| *s != Signal::TIME)
        .map(|(s, source)| (*s, column_sources::evaluate(*source, table, &rows)))
        .collect();
    if let (Some(time), Some(steps)) = (&mut time, &uneven) {
        let readings = readings(model, &signals);
        sampling_times::check_evenness(&name, (time, steps), &readings, model, out);
    }
    let numbers = || (0..rows.len()).map(|k| k as f64).collect::<Vec<f64>>();
    let time = match (time, model.data.step) {
        (Some(t), _) if model.discrete => {
            let k = time_axis::sample_numbers(&t);
            signals.push((Signal::TIME, t));
            k
        }
        (Some(t), _) => t,
        (None, Some((step, _))) if !model.discrete => numbers().iter().map(|k| k * step).collect(),
        (None, _) => numbers(),
    };
    signals.sort_by_key(|(s, _)| *s);
    for (_, values) in &mut signals {
        // Arithmetic on columns may give infinity (1/0), which counts as missing.
        values
            .iter_mut()
            .filter(|x| !x.is_finite())
            .for_each(|x| *x = f64::NAN);
    }
    Some(BoundTrajectory {
        table,
        rows,
        trajectory: Trajectory {
            name,
            file: 0,
            time,
            columns: signals,
        },
    })
}

/// What sensors read of the moving system.
fn readings<'a>(model: &Model, signals: &'a [(Signal, Vec<f64>)]) -> Vec<&'a [f64]> {
    let moves = |s: &Signal| {
        let kind = model.var(s.var).map(|v| v.kind);
        matches!(kind, Some(VarKind::State | VarKind::Output))
    };
    let moving = signals.iter().filter(|(s, _)| moves(s));
    moving.map(|(_, values)| values.as_slice()).collect()
}

/// The column that numbers the trajectories, if the model names one.
fn run_column(model: &Model, table: &Table, out: &mut Vec<Diagnostic>) -> Option<usize> {
    let (header, span) = model.data.run.as_ref()?;
    let column = table.position(header);
    if column.is_none() {
        out.push(missing_data::run(table, header, *span));
    }
    column
}

/// Rows by run, in the order of first appearance; ids are compared as text.
fn split_runs(
    table: &Table,
    run: Option<usize>,
    sources: &mut Sources,
    out: &mut Vec<Diagnostic>,
) -> Vec<(String, Vec<usize>)> {
    let file = table.name.rsplit(['/', '\\']).next().unwrap_or(&table.name);
    let Some(column) = run else {
        return vec![(file.to_string(), (0..table.len()).collect())];
    };
    let mut runs: Vec<(String, Vec<usize>)> = Vec::new();
    let mut index = std::collections::BTreeMap::new();
    for row in 0..table.len() {
        let id = table.cell(row, column);
        if id.is_empty() {
            let span = table.cell_span(sources, row, column);
            out.push(missing_data::run_id(table, row, span));
            return Vec::new();
        }
        let at = *index.entry(id).or_insert_with_key(|id| {
            runs.push((id.to_string(), Vec::new()));
            runs.len() - 1
        });
        if let Some((_, rows)) = runs.get_mut(at) {
            rows.push(row);
        }
    }
    if let [(name, _)] = runs.as_mut_slice() {
        *name = file.to_string();
    } else {
        for (name, _) in &mut runs {
            *name = format!("{file} ({name})");
        }
    }
    runs
}

/// Adds parameters from the command line as constant columns; they override columns of the same name.
fn give_params(
    model: &Model,
    params: &[(String, Vec<f64>)],
    bound: &mut [BoundTrajectory],
    out: &mut Vec<Diagnostic>,
) {
    for (place, (name, values)) in params.iter().enumerate() {
        if params.iter().take(place).any(|(n, _)| n == name) {
            out.push(missing_data::param_twice(name));
            continue;
        }
        let declared = model
            .vars
            .iter()
            .position(|v| v.name == *name && v.kind == VarKind::Param);
        let Some(id) = declared else {
            out.push(missing_data::unknown_param(model, name));
            continue;
        };
        if values.len() != 1 && values.len() != bound.len() {
            // Without trajectories another error has been reported.
            if !bound.is_empty() {
                out.push(missing_data::param_count(name, values.len(), bound));
            }
            continue;
        }
        let signal = Signal::new(VarId(id as u16));
        for (one, value) in bound.iter_mut().zip(values.iter().cycle()) {
            let m = one.rows.len();
            let columns = &mut one.trajectory.columns;
            columns.retain(|(s, _)| *s != signal);
            columns.push((signal, vec![*value; m]));
            columns.sort_by_key(|(s, _)| *s);
        }
    }
}
