//! `sidc simulate RESULT DATA…`: free runs along records, and how well they follow them.

use std::path::PathBuf;

use crate::exit_status;
use crate::failure::Failure;
use crate::inputs::result_and_records::{ResultAndRecords, ResultAndRecordsArgs};
use crate::monitoring::monitor::Monitor;
use crate::option_values::{assignments, names, quantities, time_ranges};
use crate::outputs::{diagnostics, doubts, files, stdout};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::Sources;
use sidc_system::discovery::RunParameters;
use sidc_system::simulate;
use sidc_system::simulate::thresholds::SCORES;
use sidc_system::simulate::{METHODS, Method, Options, Run, Source};

mod document;
mod table;
mod text;

const EXAMPLES: &str = "Examples:
  sidc simulate R.json data.csv                     run the equations, and compare
  sidc simulate R.json data.csv -o run.csv          keep the simulated signals
  sidc simulate R.json data.csv --window=10..20     from another row on
  sidc simulate R.json input.csv --start theta=0.1,dtheta=0";

/// Run the equations of a result along data, from their first row, and compare
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    #[command(flatten)]
    input: ResultAndRecordsArgs,
    /// Write the simulated signals here, with inputs and measurements beside them (CSV)
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Print starts, scores and faults as JSON
    #[arg(long)]
    json: bool,
    /// Simulate only times A to B, ends optional: --window=2..10, --window=..5
    #[arg(long, value_name = "A..B", value_parser = time_ranges::window, allow_hyphen_values = true)]
    window: Option<(Option<f64>, Option<f64>)>,
    /// Start here instead of where the data do: theta=0.1,dtheta=0
    #[arg(long, value_name = "x=0.1,dx=0", value_parser = assignments::start)]
    start: Vec<Vec<(String, f64)>>,
    /// Fixed steps of at most H seconds (classical Runge-Kutta), as a controller takes them, instead of error control
    #[arg(long, value_name = "H", value_parser = quantities::positive)]
    step: Option<f64>,
    /// How error-controlled steps are made: explicit until they become too many (auto), explicit, or stiff
    #[arg(long, value_parser = method, default_value = METHODS[0].0, conflicts_with = "step")]
    method: Method,
    /// Error up to which a run counts as following, in standard deviations of the measured signal
    #[arg(long, value_parser = quantities::positive, default_value_t = SCORES.bound)]
    bound: f64,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let monitor = args.input.monitor();
    files::check_writable(args.output.as_deref(), &args.input.files)?;
    let ResultAndRecords {
        name,
        opened,
        model,
        dataset,
        start,
        ..
    } = args.input.open("simulate", &args.start, &monitor)?;
    let d = &opened.discovery;
    let doubted = doubts::doubted(d).map(|w| Diagnostic::warning("doubted-result", w.text));
    let doubted = (Some(()), doubted.into_iter().collect());
    diagnostics::report(doubted, &Sources::default(), monitor.notes)?;
    monitor.listen();
    let options = Options {
        start,
        window: args.window.unwrap_or_default(),
        method: args.method,
        step: args.step,
        bound: args.bound,
        ..Options::default()
    };
    let by_run = RunParameters::of(d, &model);
    let valued = by_run.as_ref().map(|p| p.with_values(&dataset));
    let source = Source {
        discovery: by_run.as_ref().map_or(d, |p| &p.discovery),
        model: by_run.as_ref().map_or(&model, |p| &p.model),
        dataset: valued.as_ref().unwrap_or(&dataset),
    };
    let runs = runs(&source, &options, &monitor)?;
    for run in &runs {
        let found = (Some(()), run.notes.clone());
        diagnostics::report(found, &Sources::default(), monitor.notes)?;
    }
    let write = |path: &PathBuf| files::write(path, table::csv(d, &runs));
    let written = args.output.as_ref().map(write);
    if args.json {
        stdout::print(&document::json(d, &name, &runs)?)?;
    } else {
        stdout::print_readable(&text::describe(d, &runs, &options))?;
    }
    written.transpose()?;
    let ended = runs.iter().any(|r| r.fault().is_some()) || runs.len() < dataset.trajectories.len();
    Ok(if ended {
        exit_status::DOUBT
    } else {
        exit_status::PASS
    })
}

fn runs(source: &Source, options: &Options, monitor: &Monitor) -> Result<Vec<Run>, Failure> {
    let line = monitor.progress_line();
    let mut runs = Vec::new();
    for (trajectory, record) in source.dataset.trajectories.iter().enumerate() {
        // The first record is always run, so that there is something to print.
        if trajectory > 0 && monitor.must_stop() {
            break;
        }
        let mut observer = monitor.free_run(&line, &record.name);
        let run = simulate::simulate(source, trajectory, options, &mut observer)
            .map_err(|d| diagnostics::failure(&[d], &Sources::default()))?;
        runs.push(run);
        monitor.stages.done(&format!("run along {}", record.name));
    }
    Ok(runs)
}

fn method(name: &str) -> Result<Method, String> {
    names::one_of(name, METHODS.iter().copied())
}
