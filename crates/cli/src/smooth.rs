//! `sidc smooth MODEL DATA…`: the measured signals without their noise, their derivatives, and the noise.

use std::path::PathBuf;

use super::inputs::{self, Inputs};
use super::limits::{self, Limits};
use super::narrate::Talk;
use super::progress::Work;
use super::{Failure, output, status};
use sidc::pipeline;
use sidc_data as data;
use sidc_data::{Dataset, Smoothed, Trajectory};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::{Model, VarKind};
use sidc_lang::number::significant;
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, SignalNames};

/// Smooth the measured signals of a model: values, derivatives, standard errors, noise
#[derive(clap::Args)]
#[command(after_help = super::examples::SMOOTH)]
pub struct Args {
    /// A model (.sid) and one or more data files; several files are several trajectories
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Write the table here instead of to stdout
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Smooth outliers like any other value
    #[arg(long)]
    keep_outliers: bool,
    /// Use only times A to B, ends optional: --window=2..10, --window=..5
    #[arg(long, value_name = "A..B", value_parser = super::values::window, allow_hyphen_values = true)]
    window: Option<(Option<f64>, Option<f64>)>,
    /// Standard deviation of a sensor's noise, in the model's units: --noise theta=0.01
    #[arg(long, value_name = "NAME=SIGMA", value_parser = super::values::noise)]
    noise: Vec<(String, f64)>,
    /// Constant parameters: one value a trajectory, or one for all
    #[arg(long = "param", value_parser = super::values::parameter)]
    params: Vec<(String, Vec<f64>)>,
    /// Most memory for all tables, and for all libraries: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = limits::memory, default_value = limits::MEMORY)]
    memory_limit: u64,
    #[command(flatten)]
    talk: Talk,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let files = Inputs::sort(&args.files)?;
    output::ready(args.output.as_deref(), &args.files)?;
    let (notes, narrator) = (args.talk.notes(), args.talk.narrator());
    let mut sources = Sources::default();
    let file = inputs::model(files.model()?, &mut sources)?;
    let compiled = pipeline::compile(file, &sources, args.memory_limit);
    let mut program = inputs::report(compiled, &sources, notes)?;
    if files.data.is_empty() {
        return Err(Failure::new(
            "error[no-data]: no data file\n  = help: sidc smooth MODEL.sid DATA.csv",
        ));
    }
    super::values::set_noise(&mut program, &args.noise)?;
    let model = &program.model;
    if model.discrete {
        return Err(Failure::new(
            "error[not-smooth]: samples in discrete time are not samples of a smooth curve\n  = help: a model with derivatives, `dx ~ …`, smooths its signals",
        ));
    }
    let limits = Limits::start(None);
    let read = (args.memory_limit, &mut sources);
    let (tables, _) = (args.talk).tables(&files.data, read, (&limits, &narrator))?;
    let (mut dataset, mut said) = data::bind(model, &tables, &args.params, &mut sources);
    if !said.iter().any(Diagnostic::is_error) {
        said.extend(data::keep_window(
            &mut dataset,
            args.window.unwrap_or_default(),
        ));
    }
    // Here missing values are bridged; the note on their signal counts them.
    said.retain(|d| d.code != "missing-values");
    let whole = !said.iter().any(Diagnostic::is_error);
    inputs::report((whole.then_some(()), said), &sources, notes)?;

    let line = args.talk.line(&limits);
    let mut found = Vec::new();
    let curves: Vec<Vec<Curve>> = dataset
        .trajectories
        .iter()
        .map(|t| {
            let mut curve = |s| {
                line.show(Work::Preparing(model.name(s)));
                let curve = smoothed(args, model, &dataset, t, s, &mut found);
                narrator.done(&format!("{} smoothed", model.name(s)));
                curve
            };
            signals(model, t).into_iter().map(&mut curve).collect()
        })
        .collect();
    drop(line);
    let text = table(model, &dataset, &curves);
    inputs::report((Some(()), found), &sources, notes)?;
    match &args.output {
        Some(path) => output::write(path, &text)?,
        None => output::print(&text)?,
    }
    Ok(status::PASS)
}

/// A measured signal of one trajectory; `None` where there is nothing to smooth: inputs, parameters, very short records.
struct Curve {
    signal: Signal,
    smoothed: Option<Smoothed>,
}

/// What is measured, in order of the columns.
fn signals(model: &Model, trajectory: &Trajectory) -> Vec<Signal> {
    let known = |s: &Signal| model.var(s.var).is_some_and(|v| v.kind != VarKind::Time);
    let all = trajectory.columns.iter().map(|(s, _)| *s);
    all.filter(known).collect()
}

fn smoothed(
    args: &Args,
    model: &Model,
    dataset: &Dataset,
    trajectory: &Trajectory,
    signal: Signal,
    found: &mut Vec<Diagnostic>,
) -> Curve {
    let raw = Curve {
        signal,
        smoothed: None,
    };
    let kind = model.var(signal.var).map(|v| v.kind);
    let values = trajectory.column(signal).unwrap_or(&[]);
    if !matches!(kind, Some(VarKind::State | VarKind::Output)) {
        return raw;
    }
    let breaks = data::breaks(model, dataset, trajectory, signal);
    let noise = model.noise(signal);
    let mut name = model.name(signal);
    if dataset.trajectories.len() > 1 {
        name = format!("{name} of {}", trajectory.name);
    }
    let curve = data::smooth(
        &trajectory.time,
        values,
        noise,
        &breaks,
        !args.keep_outliers,
    );
    found.push(match &curve {
        Some(s) => Diagnostic::note(
            "smoothed",
            format!("{name}: {}", findings(s, values, &trajectory.time, noise)),
        ),
        None => Diagnostic::warning(
            "too-few-values",
            format!("{name}: fewer than five values; they are left as measured"),
        ),
    });
    Curve {
        smoothed: curve,
        ..raw
    }
}

/// `noise 0.0102 (1.4 % of its spread), 118 degrees of freedom in 1000 values, 3 missing, 2 outliers, the worst …`
fn findings(s: &Smoothed, values: &[f64], time: &[f64], declared: Option<f64>) -> String {
    let kept = values.iter().filter(|v| v.is_finite()).count();
    let said = match declared {
        Some(_) => ", as declared",
        None => "",
    };
    let mut text = format!(
        "noise {} ({} % of its spread{said}), ",
        significant(s.sigma, 3),
        significant(100.0 * s.sigma / spread(&s.values), 2)
    );
    text.push_str(&match s.lambda > 0.0 {
        true => format!(
            "{} degrees of freedom in {kept} values",
            significant(s.degrees_of_freedom, 3)
        ),
        false => format!("too little to smooth {kept} values"),
    });
    if kept < values.len() {
        text.push_str(&format!(", {} missing", values.len() - kept));
    }
    let far = |row: &usize| {
        let (value, curve) = (values.get(*row)?, s.values.get(*row)?);
        Some(((value - curve).abs() / s.sigma, *time.get(*row)?))
    };
    let worst = s.outliers.iter().filter_map(far);
    if let Some((sigmas, t)) = worst.max_by(|a, b| a.0.total_cmp(&b.0)) {
        let count = s.outliers.len();
        let word = if count == 1 { "outlier" } else { "outliers" };
        text.push_str(&format!(
            ", {count} {word}, the worst {} times the noise at t = {}",
            significant(sigmas, 2),
            significant(t, 6)
        ));
    }
    text
}

/// Standard deviation; the smallest number if there is none.
fn spread(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    square.sqrt().max(f64::MIN_POSITIVE)
}

/// The curves as CSV: `t`, then every signal with its standard error, absent derivatives after the signal they are of.
fn table(model: &Model, dataset: &Dataset, curves: &[Vec<Curve>]) -> String {
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
                let name = trajectory.name.replace('"', "'");
                text.push_str(&format!("\"{name}\","));
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

/// One signal of the table: `from` is the measured one whose derivative it is, or itself.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Column {
    signal: Signal,
    from: Signal,
    smooth: bool,
}

/// A signal and those of its next two derivatives that the model has and nobody measured.
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

/// As short as it reads back to the same number; nothing for a missing one.
fn number(x: Option<&f64>) -> String {
    match x {
        Some(x) if *x == 0.0 || (1e-4..1e15).contains(&x.abs()) => format!("{x}"),
        Some(x) if x.is_finite() => format!("{x:e}"),
        _ => String::new(),
    }
}
