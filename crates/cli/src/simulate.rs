//! `sidc simulate RESULT DATA…`: the equations run freely along records, and how well they follow.

use std::path::PathBuf;

use super::against::{Against, Bound};
use super::inputs;
use super::limits::Limits;
use super::narrate::{Narrator, Talk, Watch};
use super::{Failure, output, status, values};
use sidc_lang::source::Sources;
use sidc_system::simulate;
use sidc_system::simulate::{BOUND, METHODS, Method, Options, Run, Source};

mod report;

/// Run the equations of a result along data, from their first row, and compare
#[derive(clap::Args)]
#[command(after_help = super::examples::SIMULATE)]
pub struct Args {
    #[command(flatten)]
    against: Against,
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
    /// Fixed steps of at most H seconds (classical Runge-Kutta), as a controller takes them, instead of error control
    #[arg(long, value_name = "H", value_parser = positive)]
    step: Option<f64>,
    /// How error-controlled steps are made: explicit until they become too many (auto), explicit, or stiff
    #[arg(long, value_parser = method, default_value = METHODS[0].0, conflicts_with = "step")]
    method: Method,
    /// Error up to which a run counts as following, in standard deviations of the measured signal
    #[arg(long, value_parser = positive, default_value_t = BOUND)]
    bound: f64,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let talk = &args.against.talk;
    let (limits, narrator) = (Limits::start(args.against.time_limit), talk.narrator());
    let heard = (&limits, &narrator);
    output::ready(args.output.as_deref(), args.against.files())?;
    let bound = args.against.open("simulate", &args.start, heard)?;
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
    let runs = runs(&source, &options, talk, heard)?;
    for run in &runs {
        let said = (Some(()), run.notes.clone());
        inputs::report(said, &Sources::default(), talk.notes())?;
    }
    let table = |path: &PathBuf| output::write(path, &report::table(d, &runs));
    let written = args.output.as_ref().map(table);
    if args.json {
        output::print(&report::document(d, &name, &runs)?)?;
    } else {
        output::show(&report::text(d, &runs, &options))?;
    }
    written.transpose()?;
    let ended = runs.iter().any(|r| r.fault().is_some()) || runs.len() < dataset.trajectories.len();
    Ok(if ended { status::DOUBT } else { status::PASS })
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
        let mut watch = Watch {
            line: &line,
            limits,
            narrator,
            targets: &[],
            record: &record.name,
        };
        let run = simulate::simulate(source, trajectory, options, &mut watch)
            .map_err(|d| Failure::new(inputs::render(&[d], &Sources::default())))?;
        runs.push(run);
        narrator.done(&format!("run along {}", record.name));
    }
    Ok(runs)
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
