//! `sidc identify MODEL DATA…`: the main job.

use std::path::PathBuf;
use std::time::Duration;

use super::check::counted;
use super::inputs::{self, Inputs, Notes};
use super::limits::{self, Limits};
use super::narrate::{Narrator, Talk, Watch};
use super::progress;
use super::values::{self, Held};
use super::{Failure, answer, candidates, output, status};
use sidc::pipeline;
use sidc::pipeline::{Measured, Program, Rows};
use sidc_data::{HoldOut, Table};
use sidc_discover::{METHODS, Method, Options};
use sidc_lang::source::Sources;
use sidc_lang::term::SignalNames;
use sidc_solve::{SOLVERS, Solver};
use sidc_system::discovery::{Discovery, Notice};
use sidc_system::result::{CandidateEntry, FileEntry};
use sidc_system::validate::Validation;

/// Products that a verification makes in a second, of numbers of 106 bits, and how many are announced.
const PRODUCTS: f64 = 1e8;
const LONG: u128 = 1_000_000_000;

/// Find the equations of a model in data
#[derive(clap::Args)]
#[command(after_help = super::examples::IDENTIFY)]
pub struct Args {
    /// A model (.sid) and one or more data files; several files are several trajectories, several models are candidates
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Write the result document here
    #[arg(short, long)]
    pub(super) output: Option<PathBuf>,
    /// Print the result document instead of the equations
    #[arg(long)]
    pub(super) json: bool,
    /// Use N random rows; the others test the result
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) samples: Option<u32>,
    /// Seed of that draw
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// Use only times A to B, ends optional: --window=2..10, --window=..5
    #[arg(long, value_name = "A..B", value_parser = values::window, allow_hyphen_values = true)]
    pub(super) window: Option<(Option<f64>, Option<f64>)>,
    /// Find no equations from times A to B, the last part of every record, or a file, but run them there:
    /// --holdout=30..40, --holdout=25%, --holdout=test.csv
    #[arg(long, value_name = "A..B|P%|FILE", value_parser = values::held, allow_hyphen_values = true)]
    pub(super) holdout: Vec<Held>,
    /// Of several models, take the first whose run on data not used is at least as good as this, in dB: --until=-60
    #[arg(long, value_name = "DB", value_parser = values::decibels, allow_hyphen_values = true)]
    pub(super) until: Option<f64>,
    /// What equations are found from: the likelihood of the readings, trajectory and equations together (joint), estimated
    /// derivatives (regression), integrals against test functions (weak), or what suits the data (auto)
    #[arg(long, value_parser = values::method, default_value = METHODS[0].0)]
    pub(super) method: Method,
    /// Sparse solver (`sidc list` shows them)
    #[arg(long, value_parser = values::solver, default_value = SOLVERS[0].name())]
    pub(super) solver: &'static dyn Solver,
    /// Constant parameters: one value a trajectory, or one for all
    #[arg(long = "param", value_name = "m=0.3,0.5", value_parser = values::parameter)]
    pub(super) params: Vec<(String, Vec<f64>)>,
    /// Standard deviation of a signal's measurement, in units of the model: theta=0.01, ddtheta=0.5
    #[arg(long = "noise", value_name = "theta=0.01", value_parser = values::noise)]
    noise: Vec<(String, f64)>,
    /// Stop after this time with what there is: 30, 30s, 5m, 1h
    #[arg(long, value_name = "TIME", value_parser = limits::time)]
    time_limit: Option<Duration>,
    /// Most memory for all tables, for all libraries, and for the values of one: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = limits::memory, default_value = limits::MEMORY)]
    memory_limit: u64,
    /// Give readings more than five standard deviations from the trajectory no weight
    #[arg(long)]
    pub(super) robust: bool,
    /// Show after each equation the answers for larger tolerances, from the first term on
    #[arg(long)]
    pub(super) path: bool,
    /// Show all evidence: what the data tell apart, what they do not, and from which rows
    #[arg(long)]
    pub(super) evidence: bool,
    /// Check every equation and its proof once more, by separate code in 106 bits
    #[arg(long)]
    verify: bool,
    #[command(flatten)]
    talk: Talk,
}

/// A model as it was given.
#[derive(Clone)]
pub(super) struct Origin {
    pub text: String,
    /// The model, and behind it the data.
    pub files: Vec<FileEntry>,
}

/// A model and its data, ready.
pub(super) struct Candidate {
    pub path: PathBuf,
    pub origin: Origin,
    pub program: Program,
    pub measured: Measured,
    /// Warnings that travel with the result.
    pub warnings: Vec<Notice>,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let limits = Limits::start(args.time_limit);
    let narrator = args.talk.narrator();
    let files = Inputs::sort(&args.files)?;
    args.fit_together(&files)?;
    let held = args.holdout.iter().filter_map(Held::file);
    output::ready(args.output.as_deref(), args.files.iter().chain(held))?;
    let mut sources = Sources::default();
    let programs = programs(args, &files.models, &mut sources)?;
    let models = counted(programs.len(), "model", "models");
    narrator.done(&format!("{models} compiled"));
    if files.data.is_empty() {
        return Err(Failure::new(
            "error[no-data]: no data file\n  = help: sidc identify MODEL.sid DATA.csv",
        ));
    }
    let (paths, held) = held_out(args, &files);
    let read = (args.memory_limit, &mut sources);
    let (tables, entries) = args.talk.tables(&paths, read, (&limits, &narrator))?;
    inputs::report(
        (Some(()), inputs::twins(&entries)),
        &sources,
        args.talk.notes(),
    )?;
    let rows = Rows {
        window: args.window.unwrap_or_default(),
        held,
    };
    limits.listen();
    let mut ready = Vec::new();
    for (path, (mut origin, program, warnings)) in files.models.into_iter().zip(programs) {
        origin.files.extend(entries.iter().cloned());
        let model = (path, origin, program, warnings);
        let data = (tables.as_slice(), &rows);
        ready.push(prepare(args, model, data, (&mut sources, &limits))?);
        narrator.done("data bound, signals prepared");
    }
    match ready.as_slice() {
        [alone] => {
            let found = find(args, alone, &sources, (&limits, &narrator))?;
            conclude(args, alone, &found, &[])
        }
        several => candidates::run(args, several, &sources, (&limits, &narrator)),
    }
}

/// Every model compiled; the faults of all of them at once.
fn programs(
    args: &Args,
    models: &[PathBuf],
    sources: &mut Sources,
) -> Result<Vec<(Origin, Program, Vec<Notice>)>, Failure> {
    let mut failed = Failure::default();
    let mut programs = Vec::new();
    for path in models {
        let done = inputs::model_text(path).and_then(|(text, entry)| {
            let file = sources.add(path.display().to_string(), text.as_str());
            let origin = Origin {
                text,
                files: vec![entry],
            };
            let compiled = pipeline::compile(file, sources, args.memory_limit);
            let warnings = answer::said(&compiled.1);
            let mut program = inputs::report(compiled, sources, args.talk.notes())?;
            values::set_noise(&mut program, &args.noise)?;
            Ok((origin, program, warnings))
        });
        match done {
            Ok(program) => programs.push(program),
            Err(more) => failed.add(more),
        }
    }
    failed.or(programs)
}

/// Data files in the order in which they are read, and what of them is held out: a part of every record is held out of
/// several models, so that they can be compared.
fn held_out(args: &Args, files: &Inputs) -> (Vec<PathBuf>, HoldOut) {
    let mut paths = files.data.clone();
    let mut out = HoldOut::default();
    for held in &args.holdout {
        match held {
            Held::Stretch(stretch) => out.stretches.push(*stretch),
            Held::File(path) => {
                let place = paths.iter().position(|p| p == path);
                out.files.push(place.unwrap_or(paths.len()));
                if place.is_none() {
                    paths.push(path.clone());
                }
            }
        }
    }
    if files.models.len() > 1 && out.is_empty() {
        out.stretches.push(candidates::HELD_OUT);
    }
    (paths, out)
}

fn prepare(
    args: &Args,
    (path, origin, program, mut warnings): (PathBuf, Origin, Program, Vec<Notice>),
    (tables, rows): (&[Table], &Rows),
    (sources, limits): (&mut Sources, &Limits),
) -> Result<Candidate, Failure> {
    let line = args.talk.line(limits);
    let mut watch = Watch {
        line: &line,
        limits,
        narrator: &Narrator::silent(),
        targets: &[],
        record: "",
    };
    let mut staged = pipeline::measure(
        &program,
        tables,
        &args.params,
        (rows, &args.options()),
        sources,
        &mut watch,
    );
    drop(line);
    if args.method == Method::Weak {
        // Estimated derivatives are not what equations are found from then.
        let about_them = ["noisy-derivative", "input-changes-often"];
        staged.1.retain(|d| !about_them.contains(&d.code));
    }
    warnings.extend(answer::said(&staged.1));
    let measured = inputs::report(staged, sources, args.talk.notes())?;
    Ok(Candidate {
        path,
        origin,
        program,
        measured,
        warnings,
    })
}

/// What a candidate's equations are, and how they run on what was held out.
pub(super) struct Found {
    pub discovery: Discovery,
    /// `None` if nothing was.
    pub validation: Option<Validation>,
}

/// The equations of one candidate, run on what was held out.
pub(super) fn find(
    args: &Args,
    candidate: &Candidate,
    sources: &Sources,
    (limits, narrator): (&Limits, &Narrator),
) -> Result<Found, Failure> {
    let (program, measured) = (&candidate.program, &candidate.measured);
    let line = args.talk.line(limits);
    let equations = program.model.equations.iter();
    let targets: Vec<String> = equations.map(|e| program.model.name(e.target)).collect();
    let mut watch = Watch {
        line: &line,
        limits,
        narrator,
        targets: &targets,
        record: "the data",
    };
    let found = pipeline::identify(program, measured, &args.options(), &mut watch);
    narrator.close();
    narrator.done("evidence weighed");
    let mut found = found.map_err(|d| Failure::new(inputs::render(&d, sources)))?;
    if args.verify {
        if args.talk.notes() != Notes::None {
            announce(pipeline::verification_work(program, measured, &found));
        }
        pipeline::verify(program, measured, &mut found, &mut watch);
        narrator.close();
    }
    let validation = pipeline::validate(program, measured, &mut found, &mut watch);
    if validation.is_some() {
        narrator.done("run on data held out");
    }
    Ok(Found {
        discovery: found,
        validation,
    })
}

/// Says how long a verification takes, if that is long enough to wonder.
fn announce(products: u128) {
    if products > LONG {
        let seconds = products as f64 / PRODUCTS;
        progress::instead(&format!(
            "verifying: {:.1e} products in 106 bits, some {seconds:.0} s; Ctrl-C or --time-limit ends it\n",
            products as f64
        ));
    }
}

/// Writes and prints what was found; the exit status.
pub(super) fn conclude(
    args: &Args,
    candidate: &Candidate,
    found: &Found,
    others: &[CandidateEntry],
) -> Result<u8, Failure> {
    let document = answer::document(args, candidate, found, others)?;
    // A disk may be full by now: what was found is printed all the same.
    let written = args
        .output
        .as_ref()
        .map(|path| output::write(path, &document));
    if args.json {
        output::print(&document)?;
    } else {
        output::show(&answer::text(args, candidate, found, others))?;
    }
    written.transpose()?;
    Ok(match found.discovery.passes() {
        true => status::PASS,
        false => status::DOUBT,
    })
}

impl Args {
    /// # Errors
    /// Options that would be without effect beside the others.
    fn fit_together(&self, files: &Inputs) -> Result<(), Failure> {
        let (drawn, joint) = (self.samples.is_some(), self.method == Method::Joint);
        let trajectory = "equations and trajectory are estimated together from all readings";
        let cases = [
            (
                drawn && self.method == Method::Weak,
                "--samples",
                "integrals are taken over all rows",
                "shorten the record with --window, or leave out --method weak",
            ),
            (
                drawn && joint,
                "--samples",
                trajectory,
                "leave out --method joint, or shorten the record with --window",
            ),
            (
                self.path && joint,
                "--path",
                trajectory,
                "leave out --method joint",
            ),
            (
                self.until.is_some() && files.models.len() == 1,
                "--until",
                "it chooses among several models, and there is one",
                "give more models, or leave it out",
            ),
        ];
        let mut failed = Failure::default();
        for (_, option, why, way_out) in cases.into_iter().filter(|(holds, ..)| *holds) {
            failed.add(Failure::new(format!(
                "error[option-without-effect]: {option}: {why}\n  = help: {way_out}"
            )));
        }
        failed.or(())
    }

    fn options(&self) -> Options {
        Options {
            method: self.method,
            solver: self.solver,
            samples: self.samples.map(|n| n as usize),
            seed: self.seed,
            memory: self.memory_limit,
            path: self.path,
            robust: self.robust,
        }
    }
}
