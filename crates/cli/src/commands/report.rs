//! `sidc report RESULT… DATA…`: a result as one page, with free runs along the data; or several results compared on one page.

use std::path::PathBuf;

use crate::exit_status;
use crate::failure::Failure;
use crate::inputs::result_and_records::{ResultAndRecords, ResultAndRecordsArgs};
use crate::monitoring::monitor::Monitor;
use crate::monitoring::progress_line::{ProgressLine, Work};
use crate::outputs::files;
use sidc_emit::report;
use sidc_emit::report::{RecordRun, Subject};
use sidc_system::discovery::RunParameters;
use sidc_system::result::Document;
use sidc_system::simulate;
use sidc_system::simulate::{Options, Source};

const EXAMPLES: &str = "Examples:
  sidc report R.json data.csv -o report.html        one page to look at, to print, to mail
  sidc report R.json new.csv -o new.html            held against data the equations have not seen
  sidc report A.json B.json data.csv -o both.html   two results compared on one page";

/// Write a result as one page of HTML: equations, evidence, runs along data; or compare several
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    #[command(flatten)]
    input: ResultAndRecordsArgs,
    /// Write the page here instead of on standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let monitor = args.input.monitor();
    files::check_writable(args.output.as_deref(), &args.input.files)?;
    let all = args.input.open_each("report", &monitor)?;
    monitor.listen();
    let line = monitor.progress_line();
    let runs: Vec<Vec<RecordRun>> = all
        .iter()
        .map(|bound| run_along(bound, &line, &monitor))
        .collect();
    line.show(Work::Drawing);
    let subjects: Vec<Subject> = all
        .iter()
        .zip(&runs)
        .map(|(bound, runs)| Subject {
            discovery: &bound.opened.discovery,
            document: &bound.opened.document,
            name: &bound.name,
            dataset: &bound.dataset,
            runs,
            files: &bound.files,
        })
        .collect();
    let page = match subjects.as_slice() {
        [one] => report::html(one),
        several => report::comparison(several),
    };
    drop(line);
    monitor.stages.done("page drawn");
    files::write_or_print(args.output.as_deref(), &page)?;
    Ok(exit_status::PASS)
}

/// Runs the equations of one result along the data.
fn run_along(bound: &ResultAndRecords, line: &ProgressLine, monitor: &Monitor) -> Vec<RecordRun> {
    let discovery = &bound.opened.discovery;
    let by_run = RunParameters::of(discovery, &bound.model);
    let valued = by_run.as_ref().map(|p| p.with_values(&bound.dataset));
    let source = Source {
        discovery: by_run.as_ref().map_or(discovery, |p| &p.discovery),
        model: by_run.as_ref().map_or(&bound.model, |p| &p.model),
        dataset: valued.as_ref().unwrap_or(&bound.dataset),
    };
    runs(&source, &bound.opened.document, line, monitor)
}

/// Runs along every record until the time is up; held-out rows are run separately. The page says why a record cannot be run.
fn runs(
    source: &Source,
    document: &Document,
    line: &ProgressLine,
    monitor: &Monitor,
) -> Vec<RecordRun> {
    let mut runs = Vec::new();
    for (trajectory, record) in source.dataset.trajectories.iter().enumerate() {
        for (held, window) in report::run_windows(document, record) {
            if !runs.is_empty() && monitor.must_stop() {
                return runs;
            }
            let mut observer = monitor.free_run(line, &record.name);
            let options = Options {
                window,
                ..Options::default()
            };
            let run = simulate::simulate(source, trajectory, &options, &mut observer);
            runs.push(RecordRun {
                trajectory,
                held_out: held,
                run: run.map_err(|d| d.message),
            });
            monitor.stages.done(&format!("run along {}", record.name));
        }
    }
    runs
}
