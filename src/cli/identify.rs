//! `sidc identify MODEL DATA…`: the main job.

use std::path::PathBuf;
use std::time::Duration;

use super::inputs::{self, Inputs, Notes};
use super::limits::{self, Limits};
use super::progress::{Line, Work};
use super::{Failure, hint, output, status};
use crate::discover::{Discovery, METHODS, Method, Options, Reason};
use crate::emit;
use crate::lang::diagnostic::{Diagnostic, Severity, did_you_mean};
use crate::lang::model::{Model, VarKind};
use crate::lang::source::Sources;
use crate::pipeline::{self, Measured, Program};
use crate::result::{self, Settings, SignalEntry};
use crate::solve::{SOLVERS, Solver};
use crate::term::{Signal, SignalNames, VarId};

/// Find the equations of a model in data
#[derive(clap::Args)]
pub struct Args {
    /// A model (.sid) and one or more data files; several files are several trajectories
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Write the result document here
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Print the result document instead of the equations
    #[arg(long)]
    json: bool,
    /// Use N random rows; the others test the result
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    samples: Option<u32>,
    /// Seed of that draw
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Use only times A to B, ends optional: --window=2..10, --window=..5
    #[arg(long, value_name = "A..B", value_parser = window, allow_hyphen_values = true)]
    window: Option<(Option<f64>, Option<f64>)>,
    /// What equations are found from: the likelihood of the readings, trajectory and equations together (joint), estimated
    /// derivatives (regression), integrals against test functions (weak), or what suits the data (auto)
    #[arg(long, value_parser = method, default_value = METHODS[0].0)]
    method: Method,
    /// Sparse solver (`sidc list` shows them)
    #[arg(long, value_parser = solver, default_value = SOLVERS[0].name())]
    solver: &'static dyn Solver,
    /// Constant parameters: one value a trajectory, or one for all
    #[arg(long = "param", value_name = "m=0.3,0.5", value_parser = parameter)]
    params: Vec<(String, Vec<f64>)>,
    /// Standard deviation of a signal's measurement, in units of the model: theta=0.01, ddtheta=0.5
    #[arg(long = "noise", value_name = "theta=0.01", value_parser = noise)]
    noise: Vec<(String, f64)>,
    /// Stop after this time with what there is: 30, 30s, 5m, 1h
    #[arg(long, value_name = "TIME", value_parser = limits::time)]
    time_limit: Option<Duration>,
    /// Most memory for a table, a library, and its values: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = limits::memory, default_value = limits::MEMORY)]
    memory_limit: u64,
    /// Give readings more than five standard deviations from the trajectory no weight
    #[arg(long)]
    robust: bool,
    /// Show after each equation the answers for larger tolerances, from the first term on
    #[arg(long)]
    path: bool,
    /// Show all evidence: what the data tell apart, what they do not, and from which rows
    #[arg(long)]
    evidence: bool,
    /// Only warnings and errors on stderr
    #[arg(short, long)]
    quiet: bool,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let limits = Limits::start(args.time_limit);
    let files = Inputs::sort(&args.files)?;
    let notes = if args.quiet {
        Notes::None
    } else {
        Notes::Lines
    };
    let mut sources = Sources::default();
    let file = inputs::model(&files.model, &mut sources)?;
    let compiled = pipeline::compile(file, &sources, args.memory_limit);
    if files.data.is_empty() {
        inputs::report(compiled, &sources, notes)?;
        return Err(Failure::new(
            "error[no-data]: no data file\n  = help: sidc identify MODEL.sid DATA.csv",
        ));
    }
    let mut warnings = said(&compiled.1);
    let mut program = inputs::report(compiled, &sources, notes)?;
    set_noise(&mut program, &args.noise)?;
    let tables = inputs::tables(&files.data, args.memory_limit, &mut sources)?;
    let window = args.window.unwrap_or_default();
    limits.listen();
    let line = Line::start(!args.quiet, &program.model, &limits);
    let options = Options {
        method: args.method,
        solver: args.solver,
        samples: args.samples.map(|n| n as usize),
        seed: args.seed,
        memory: args.memory_limit,
        path: args.path,
        robust: args.robust,
    };
    let mut staged = pipeline::measure(
        &program,
        &tables,
        &args.params,
        (window, &options),
        &mut sources,
        &mut |signal| {
            line.show(Work::Preparing(program.model.name(signal)));
            limits.go_on()
        },
    );
    line.rest();
    if args.method == Method::Weak {
        // Estimated derivatives are not what equations are found from then.
        let about_them = ["noisy-derivative", "input-changes-often"];
        staged.1.retain(|d| !about_them.contains(&d.code));
    }
    warnings.extend(said(&staged.1));
    let measured = inputs::report(staged, &sources, notes)?;

    let found = pipeline::identify(&program, &measured, &options, &mut |step| {
        line.show(Work::Equation(step));
        limits.check()
    });
    drop(line);
    let discovery = found.map_err(|d| Failure::new(inputs::render(&d, &sources)))?;

    let settings = settings(args, &files, &measured);
    let document = result::write(
        &discovery,
        &settings,
        &signal_entries(&program, &measured),
        &warnings,
    )
    .map_err(|e| Failure::new(format!("error[internal]: {e}; please report this")))?;
    if let Some(path) = &args.output {
        output::write(path, &document)?;
    }
    if args.json {
        output::print(&document)?;
    } else {
        output::print(&answer(args, &program, &measured, &discovery))?;
    }
    Ok(if discovery.passes() {
        status::PASS
    } else {
        status::DOUBT
    })
}

fn answer(args: &Args, program: &Program, measured: &Measured, d: &Discovery) -> String {
    let mut text = String::new();
    let rows = measured.rows();
    let drawn = match args.samples {
        Some(n) if (n as usize) < rows => format!(" ({n} drawn, seed {})", args.seed),
        _ => String::new(),
    };
    let rows = match rows {
        0 => "no rows were ready".into(),
        n if measured.joint.is_some() => format!("{n} samples"),
        n => format!("{n} rows{drawn}"),
    };
    text.push_str(&format!(
        "{}: {rows} from {}\n\n",
        d.system.as_deref().unwrap_or("system"),
        trajectories(measured)
    ));
    text.push_str(&emit::answer(d, args.evidence));
    text.push('\n');
    text.push_str(&signals_text(program, measured));
    text
}

/// The one trajectory by name, several by their number.
pub(super) fn trajectories(measured: &Measured) -> String {
    match measured.dataset.trajectories.as_slice() {
        [one] => one.name.clone(),
        many => format!("{} trajectories", many.len()),
    }
}

/// What was measured and what was estimated, and how.
pub(super) fn signals_text(program: &Program, measured: &Measured) -> String {
    let entries = signal_entries(program, measured);
    let columns = measured.dataset.trajectories.first().map(|t| &t.columns);
    let columns: Vec<String> = columns
        .into_iter()
        .flatten()
        .map(|(signal, _)| program.model.name(*signal))
        .collect();
    let mut text = format!("measured: {}\n", columns.join(", "));
    for e in &entries {
        if let Some(error) = e.error {
            text.push_str(&format!(
                "estimated: {} by {}, error about {} of its size\n",
                e.signal,
                e.origin,
                emit::significant(error, 2)
            ));
        }
    }
    text
}

fn signal_entries(program: &Program, measured: &Measured) -> Vec<SignalEntry> {
    measured
        .report
        .iter()
        .map(|r| SignalEntry {
            signal: program.model.name(r.signal),
            origin: r.method.clone(),
            error: r.error.map(|e| e / r.rms.max(f64::MIN_POSITIVE)),
        })
        .collect()
}

fn settings(args: &Args, files: &Inputs, measured: &Measured) -> Settings {
    Settings {
        model: inputs::short_name(&files.model),
        data: measured
            .dataset
            .trajectories
            .iter()
            .map(|t| t.name.clone())
            .collect(),
        method: args.method.chosen().into(),
        solver: args.solver.name().into(),
        samples: args.samples.map(|n| n as usize),
        seed: args.seed,
        window: args.window,
    }
}

/// Warnings travel with the result; notes do not.
fn said(diagnostics: &[Diagnostic]) -> Vec<Reason> {
    diagnostics
        .iter()
        .filter(|d| d.severity == Severity::Warning)
        .map(|d| Reason::new(d.code, &d.message))
        .collect()
}

fn method(name: &str) -> Result<Method, String> {
    let names = METHODS.iter().map(|(n, _)| *n);
    let found = METHODS.iter().find(|(n, _)| *n == name);
    found.map(|(_, m)| *m).ok_or_else(|| {
        let known: Vec<&str> = names.clone().collect();
        match did_you_mean(name, names) {
            Some(n) => format!("did you mean `{n}`? known: {}", known.join(", ")),
            None => format!("known: {}", known.join(", ")),
        }
    })
}

fn solver(name: &str) -> Result<&'static dyn Solver, String> {
    let names = SOLVERS.iter().map(|s| s.name());
    SOLVERS
        .iter()
        .copied()
        .find(|s| s.name() == name)
        .ok_or_else(|| {
            let known: Vec<&str> = names.clone().collect();
            match did_you_mean(name, names) {
                Some(n) => format!("did you mean `{n}`? known: {}", known.join(", ")),
                None => format!("known: {}", known.join(", ")),
            }
        })
}

/// `2..10`, `..5`, `3..`
pub(super) fn window(text: &str) -> Result<(Option<f64>, Option<f64>), String> {
    let (from, to) = text
        .split_once("..")
        .ok_or("write a stretch of time as A..B")?;
    let end = |t: &str| -> Result<Option<f64>, String> {
        if t.trim().is_empty() {
            return Ok(None);
        }
        match t.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(Some(x)),
            _ => Err(format!("`{t}` is not a time in seconds")),
        }
    };
    let (from, to) = (end(from)?, end(to)?);
    match (from, to) {
        (Some(a), Some(b)) if a >= b => Err(format!("{a} is not before {b}")),
        ends => Ok(ends),
    }
}

/// `theta=0.01`
pub(super) fn noise(text: &str) -> Result<(String, f64), String> {
    match parameter(text)? {
        (name, values) if values.len() == 1 && values.iter().all(|x| *x > 0.0) => {
            Ok((name, values.iter().sum()))
        }
        _ => Err("a noise is one number above 0, a standard deviation".into()),
    }
}

/// What the command line says of the sensors holds over the model.
pub(super) fn set_noise(program: &mut Program, noise: &[(String, f64)]) -> Result<(), Failure> {
    let signals = sensors(&program.model);
    for (name, sigma) in noise {
        if let Some((_, signal)) = signals.iter().find(|(n, _)| n == name) {
            if let Some(var) = program.model.vars.get_mut(signal.var.0 as usize) {
                var.noise.insert(signal.der, *sigma);
            }
            continue;
        }
        let names = signals.iter().map(|(n, _)| n.as_str());
        let hint = hint(name, names.clone());
        return Err(Failure::new(format!(
            "error[unknown-noise]: --noise {name}: the model measures no signal of this name{hint}\n  = measured: {}",
            names.collect::<Vec<_>>().join(", ")
        )));
    }
    Ok(())
}

/// Every signal that a table may hold, by name: variables, then their derivatives.
fn sensors(model: &Model) -> Vec<(String, Signal)> {
    let orders = (0..=model.vars.iter().map(|v| v.order).max().unwrap_or(0)).flat_map(|der| {
        let vars = (0..).zip(&model.vars);
        vars.filter(move |(_, v)| {
            der <= v.order && !matches!(v.kind, VarKind::Time | VarKind::Param)
        })
        .map(move |(id, _)| Signal {
            der,
            ..Signal::new(VarId(id))
        })
    });
    orders.map(|s| (model.name(s), s)).collect()
}

/// `m=0.3,0.5`
pub(super) fn parameter(text: &str) -> Result<(String, Vec<f64>), String> {
    let (name, values) = text
        .split_once('=')
        .ok_or("write a parameter as name=value")?;
    let values: Result<Vec<f64>, String> = values
        .split(',')
        .map(|v| match v.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => Err(format!("`{v}` is not a number")),
        })
        .collect();
    Ok((name.trim().to_string(), values?))
}
