//! `sidc simulate RESULT DATA…`: the equations run freely along records, and how well they follow.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::check::counted;
use super::inputs;
use super::limits::{self, Limits};
use super::narrate::{Narrator, Talk};
use super::progress::{Line, Work};
use super::{Failure, hint, output, status, values};
use crate::data::{self, Dataset};
use crate::discover::Discovery;
use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::Model;
use crate::lang::source::{FileId, Sources};
use crate::result::{self, FileEntry, Opened};
use crate::simulate::{self, BOUND, METHODS, Method, Options, Run, Source};
use crate::term::{Signal, SignalNames};

mod report;

/// Run the equations of a result along data, from their first row, and compare
#[derive(clap::Args)]
#[command(after_help = super::examples::SIMULATE)]
pub struct Args {
    /// Result of `sidc identify … -o R.json`, and one or more data files; each trajectory is a run of its own
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Write the simulated signals here, with inputs and measurements beside them (CSV)
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Print starts, scores and faults as JSON
    #[arg(long)]
    json: bool,
    /// Simulate only times A to B, ends optional: --window=2..10, --window=..5
    #[arg(long, value_name = "A..B", value_parser = values::window, allow_hyphen_values = true)]
    window: Option<(Option<f64>, Option<f64>)>,
    /// Start here instead of where the data do: theta=0.1,dtheta=0
    #[arg(long, value_name = "x=0.1,dx=0", value_parser = start)]
    start: Vec<Vec<(String, f64)>>,
    /// Constant parameters: one value a trajectory, or one for all
    #[arg(long = "param", value_name = "m=0.3,0.5", value_parser = values::parameter)]
    params: Vec<(String, Vec<f64>)>,
    /// Fixed steps of at most H seconds (classical Runge-Kutta), as a controller takes them, instead of error control
    #[arg(long, value_name = "H", value_parser = positive)]
    step: Option<f64>,
    /// How error-controlled steps are made: explicit until they become too many (auto), explicit, or stiff
    #[arg(long, value_parser = method, default_value = METHODS[0].0, conflicts_with = "step")]
    method: Method,
    /// Error up to which a run counts as following, in standard deviations of the measured signal
    #[arg(long, value_parser = positive, default_value_t = BOUND)]
    bound: f64,
    /// Stop after this time with what there is: 30, 30s, 5m, 1h
    #[arg(long, value_name = "TIME", value_parser = limits::time)]
    time_limit: Option<Duration>,
    /// Most memory for a table: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = limits::memory, default_value = limits::MEMORY)]
    memory_limit: u64,
    #[command(flatten)]
    talk: Talk,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let limits = Limits::start(args.time_limit);
    let (result, data) = sort(&args.files, "simulate")?;
    let narrator = args.talk.narrator();
    let reading = Reading {
        params: &args.params,
        memory: args.memory_limit,
        talk: &args.talk,
    };
    let bound = bound(result, data, &reading, &args.start, (&limits, &narrator))?;
    let Bound {
        name,
        opened,
        model,
        dataset,
        given,
        ..
    } = bound;
    let d = &opened.discovery;
    limits.listen();
    let options = Options {
        start: given,
        window: args.window.unwrap_or_default(),
        method: args.method,
        step: args.step,
        bound: args.bound,
    };
    let source = Source {
        discovery: d,
        model: &model,
        dataset: &dataset,
    };
    let runs = runs(&source, &options, &args.talk, (&limits, &narrator))?;
    for run in &runs {
        let said = (Some(()), run.notes.clone());
        inputs::report(said, &Sources::default(), args.talk.notes())?;
    }
    if let Some(path) = &args.output {
        output::write(path, &report::table(d, &runs))?;
    }
    if args.json {
        output::print(&report::document(d, &name, &runs)?)?;
    } else {
        output::show(&report::text(d, &runs, &options))?;
    }
    let ended = runs.iter().any(|r| r.fault().is_some()) || runs.len() < dataset.trajectories.len();
    Ok(if ended { status::DOUBT } else { status::PASS })
}

/// A result and records that are read as its own were.
pub(super) struct Bound {
    /// Of the result's file, without folders.
    pub name: String,
    pub opened: Opened,
    pub model: Model,
    pub dataset: Dataset,
    pub files: Vec<FileEntry>,
    pub given: Vec<(Signal, f64)>,
}

/// How data are read.
pub(super) struct Reading<'a> {
    pub params: &'a [(String, Vec<f64>)],
    pub memory: u64,
    pub talk: &'a Talk,
}

/// Reads a result and binds data to what a simulation of it reads; components of the state in `start` need no column.
pub(super) fn bound(
    result: &Path,
    data: &[PathBuf],
    reading: &Reading,
    start: &[Vec<(String, f64)>],
    (limits, narrator): (&Limits, &Narrator),
) -> Result<Bound, Failure> {
    let name = inputs::short_name(result);
    let opened = result::open(&name, &inputs::result(result)?)
        .map_err(|d| Failure::new(inputs::render(&[d], &Sources::default())))?;
    let given = given(&opened.discovery, start)?;
    let model = simulate::reads(&opened.discovery, &opened.model, &given);
    let mut sources = Sources::default();
    // Places in a model that nobody wrote are not shown; they are those of the first text.
    sources.add(name.as_str(), "");
    narrator.done("result read");
    let line = reading.talk.line(limits);
    let read = inputs::tables_and_entries(data, reading.memory, &mut sources, &line);
    drop(line);
    let (tables, files) = read?;
    narrator.done(&format!(
        "{} read",
        counted(tables.len(), "table", "tables")
    ));
    let (dataset, mut said) = data::bind(&model, &tables, reading.params, &mut sources);
    // A library is nobody's concern here.
    said.retain(|d| d.code != "constant-column");
    said.iter_mut().for_each(|d| to_user_of_result(d, &name));
    let whole = !said.iter().any(Diagnostic::is_error);
    inputs::report((whole.then_some(()), said), &sources, reading.talk.notes())?;
    narrator.done("data bound");
    Ok(Bound {
        name,
        opened,
        model,
        dataset,
        files,
        given,
    })
}

fn runs(
    source: &Source,
    options: &Options,
    talk: &Talk,
    (limits, narrator): (&Limits, &Narrator),
) -> Result<Vec<Run>, Failure> {
    let line = talk.line(limits);
    let mut runs = Vec::new();
    for (trajectory, record) in source.dataset.trajectories.iter().enumerate() {
        // A run that was never begun has nothing to keep.
        if trajectory > 0 && limits.go_on().is_break() {
            break;
        }
        let mut go_on = watch(&record.name, &line, limits);
        let run = simulate::simulate(source, trajectory, options, &mut go_on)
            .map_err(|d| Failure::new(inputs::render(&[d], &Sources::default())))?;
        runs.push(run);
        narrator.done(&format!("run along {}", record.name));
    }
    Ok(runs)
}

/// Shows how far a run is, and ends it when time is up.
pub(super) fn watch(name: &str, line: &Line, limits: &Limits) -> impl FnMut(f64) -> bool {
    |time| {
        line.show(Work::Running(name.into(), time));
        limits.go_on().is_continue()
    }
}

/// The result among the files, and the rest.
pub(super) fn sort<'a>(
    files: &'a [PathBuf],
    command: &str,
) -> Result<(&'a Path, &'a [PathBuf]), Failure> {
    let Some((result, data)) = files.split_first() else {
        return Err(Failure::new("error[no-data]: no files"));
    };
    if data.is_empty() {
        return Err(Failure::new(format!(
            "error[no-data]: no data file\n  = help: sidc {command} R.json DATA.csv"
        )));
    }
    Ok((result, data))
}

/// Names of `--start` as signals of the state.
fn given(d: &Discovery, start: &[Vec<(String, f64)>]) -> Result<Vec<(Signal, f64)>, Failure> {
    let state = crate::discover::Form::new(d).state;
    let signal = |(name, value): &(String, f64)| {
        let found = state.iter().find(|s| d.name(**s) == *name);
        found.map(|s| (*s, *value)).ok_or_else(|| {
            let names: Vec<String> = state.iter().map(|s| d.name(*s)).collect();
            let hint = hint(name, names.iter().map(String::as_str));
            Failure::new(format!(
                "error[unknown-start]: --start {name}: the state has no component of this name{hint}\n  = state: {}",
                names.join(", ")
            ))
        })
    };
    start.iter().flatten().map(signal).collect()
}

/// What binding says is about a model that the user may not have; here it is about the result.
fn to_user_of_result(d: &mut Diagnostic, name: &str) {
    d.labels.retain(|l| l.span.file != FileId(0));
    let advice = d.help.as_deref().unwrap_or_default();
    if d.is_error() && advice.starts_with("data {") {
        d.help = Some(format!(
            "{name} reads its columns as its model did: name the column so, or identify again with {advice}"
        ));
    }
    if d.code == "input-between" || d.code == "slope-disagrees" {
        d.help = None;
    }
}

/// `theta=0.1,dtheta=0`
fn start(text: &str) -> Result<Vec<(String, f64)>, String> {
    let one = |part: &str| {
        let (name, value) = part
            .split_once('=')
            .ok_or("write a start as name=value,name=value")?;
        match value.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok((name.trim().to_string(), x)),
            _ => Err(format!("`{value}` is not a number")),
        }
    };
    text.split(',').map(one).collect()
}

fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x.is_finite() && x > 0.0 => Ok(x),
        _ => Err(format!("`{text}` is not a number above 0")),
    }
}

fn method(name: &str) -> Result<Method, String> {
    values::one_of(name, METHODS.iter().copied())
}
