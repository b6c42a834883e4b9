//! `sidc report RESULT DATA…`: the result as one page, with the equations run along the data.

use std::path::PathBuf;

use super::against::Against;
use super::limits::Limits;
use super::narrate::{Narrator, Watch};
use super::progress::{Line, Work};
use super::{Failure, output, status};
use sidc_emit::report;
use sidc_emit::report::{RecordRun, Subject};
use sidc_system::result::Document;
use sidc_system::simulate;
use sidc_system::simulate::{Options, Source};

/// Write a result as one page of HTML: equations, evidence, runs along data
#[derive(clap::Args)]
#[command(after_help = super::examples::REPORT)]
pub struct Args {
    #[command(flatten)]
    against: Against,
    /// Write the page here instead of on standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let talk = &args.against.talk;
    let (limits, narrator) = (Limits::start(args.against.time_limit), talk.narrator());
    output::ready(args.output.as_deref(), args.against.files())?;
    let bound = args.against.open("report", &[], (&limits, &narrator))?;
    limits.listen();
    let source = Source {
        discovery: &bound.opened.discovery,
        model: &bound.model,
        dataset: &bound.dataset,
    };
    let line = talk.line(&limits);
    let runs = runs(&source, &bound.opened.document, &line, (&limits, &narrator));
    line.show(Work::Drawing);
    let page = report::html(&Subject {
        discovery: source.discovery,
        document: &bound.opened.document,
        name: &bound.name,
        dataset: source.dataset,
        runs: &runs,
        files: &bound.files,
    });
    drop(line);
    narrator.done("page drawn");
    match &args.output {
        Some(path) => output::write(path, &page)?,
        None => output::print(&page)?,
    }
    Ok(status::PASS)
}

/// Runs along every record, until time is up; stretches held out are run by themselves. The page names records that cannot be run.
fn runs(
    source: &Source,
    document: &Document,
    line: &Line,
    (limits, narrator): (&Limits, &Narrator),
) -> Vec<RecordRun> {
    let mut runs = Vec::new();
    for (trajectory, record) in source.dataset.trajectories.iter().enumerate() {
        for (held, window) in report::run_windows(document, record) {
            if !runs.is_empty() && limits.go_on().is_break() {
                return runs;
            }
            let mut watch = Watch {
                line,
                limits,
                narrator,
                targets: &[],
                record: &record.name,
            };
            let options = Options {
                window,
                ..Options::default()
            };
            let run = simulate::simulate(source, trajectory, &options, &mut watch);
            runs.push(RecordRun {
                trajectory,
                held_out: held,
                run: run.map_err(|d| d.message),
            });
            narrator.done(&format!("run along {}", record.name));
        }
    }
    runs
}
