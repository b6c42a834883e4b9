//! `sidc smooth MODEL DATA…`: the measured signals with their noise removed, their derivatives, and the noise.

use std::path::PathBuf;

use crate::exit_status;
use crate::failure::Failure;
use crate::inputs::files::InputFiles;
use crate::inputs::{tables, texts};
use crate::monitoring::monitor::Monitor;
use crate::monitoring::progress_line::Work;
use crate::monitoring::verbosity::Verbosity;
use crate::option_values::{assignments, quantities, time_ranges};
use crate::outputs::{diagnostics, files};
use sidc::pipeline;
use sidc_data as data;
use sidc_data::{Dataset, Smoothed, Trajectory};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::{Model, VarKind};
use sidc_lang::number::significant;
use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, SignalNames};

mod table;

use table::Curve;

const EXAMPLES: &str = "Examples:
  sidc smooth pendulum.sid data.csv -o smooth.csv         curves, derivatives, standard errors
  sidc smooth pendulum.sid data.csv --noise theta=0.01    with a noise that is known";

/// Smooth the measured signals of a model: values, derivatives, standard errors, noise
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
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
    #[arg(long, value_name = "A..B", value_parser = time_ranges::window, allow_hyphen_values = true)]
    window: Option<(Option<f64>, Option<f64>)>,
    /// Noise of a sensor: a standard deviation in the model's units or a share of the value: theta=0.01, x=2%
    #[arg(long, value_name = "NAME=SIGMA", value_parser = assignments::noise)]
    noise: Vec<(String, SensorNoise)>,
    /// Constant parameters: one value a trajectory, or one for all
    #[arg(long = "param", value_parser = assignments::parameter)]
    params: Vec<(String, Vec<f64>)>,
    /// Most memory for all tables, and for all libraries: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = quantities::memory, default_value = quantities::MEMORY)]
    memory_limit: u64,
    #[command(flatten)]
    verbosity: Verbosity,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let monitor = Monitor::start(&args.verbosity, None);
    let inputs = InputFiles::sort(&args.files)?;
    files::check_writable(args.output.as_deref(), &args.files)?;
    let mut sources = Sources::default();
    let (file, _) = texts::model(inputs.model()?, &mut sources)?;
    let compiled = pipeline::compile(file, &sources, args.memory_limit);
    let mut program = diagnostics::report(compiled, &sources, monitor.notes)?;
    if inputs.data.is_empty() {
        return Err(Failure::new(
            "error[no-data]: no data file\n  = help: sidc smooth MODEL.sid DATA.csv",
        ));
    }
    assignments::set_noise(&mut program, &args.noise)?;
    let model = &program.model;
    if model.discrete {
        return Err(Failure::new(
            "error[not-smooth]: samples in discrete time are not samples of a smooth curve\n  = help: a model with derivatives, `dx ~ …`, smooths its signals",
        ));
    }
    let read = tables::read(&inputs.data, args.memory_limit, &mut sources, &monitor)?;
    let (mut dataset, mut found) = data::bind(model, &read.tables, &args.params, &mut sources);
    if !found.iter().any(Diagnostic::is_error) {
        found.extend(data::keep_window(
            &mut dataset,
            args.window.unwrap_or_default(),
        ));
    }
    // The curve bridges missing values, and the note on its signal already counts them.
    found.retain(|d| d.code != "missing-values");
    let complete = !found.iter().any(Diagnostic::is_error);
    diagnostics::report((complete.then_some(()), found), &sources, monitor.notes)?;

    let line = monitor.progress_line();
    let mut found = Vec::new();
    let curves: Vec<Vec<Curve>> = dataset
        .trajectories
        .iter()
        .map(|t| {
            let mut curve = |s| {
                line.show(Work::Preparing {
                    signal: model.name(s),
                });
                let curve = smoothed(args, model, &dataset, t, s, &mut found);
                monitor.stages.done(&format!("{} smoothed", model.name(s)));
                curve
            };
            signals(model, t).into_iter().map(&mut curve).collect()
        })
        .collect();
    drop(line);
    let text = table::csv(model, &dataset, &curves);
    diagnostics::report((Some(()), found), &sources, monitor.notes)?;
    files::write_or_print(args.output.as_deref(), &text)?;
    Ok(exit_status::PASS)
}

/// The measured signals, in the order of the columns.
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
    let noise = model.noise(signal).map(|noise| noise.rms(values));
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

/// Standard deviation, or the smallest positive number if it is zero.
fn spread(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    square.sqrt().max(f64::MIN_POSITIVE)
}
