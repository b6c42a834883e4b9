//! `sidc report RESULT DATA…`: the result as one page, with the equations run along the data.

use std::path::PathBuf;
use std::time::Duration;

use super::limits::{self, Limits};
use super::narrate::{Narrator, Talk};
use super::progress::{Line, Work};
use super::simulate::{Reading, bound, sort, watch};
use super::{Failure, output, status, values};
use crate::report::{self, Along, Subject};
use crate::result::Document;
use crate::simulate::{self, Options, Source};

/// Write a result as one page of HTML: equations, evidence, runs along data
#[derive(clap::Args)]
#[command(after_help = super::examples::REPORT)]
pub struct Args {
    /// Result of `sidc identify … -o R.json`, and the data files that it is held against
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Write the page here instead of on standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Constant parameters: one value a trajectory, or one for all
    #[arg(long = "param", value_name = "m=0.3,0.5", value_parser = values::parameter)]
    params: Vec<(String, Vec<f64>)>,
    /// End the runs after this time, and show what there is: 30, 30s, 5m, 1h
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
    let (result, data) = sort(&args.files, "report")?;
    let narrator = args.talk.narrator();
    let reading = Reading {
        params: &args.params,
        memory: args.memory_limit,
        talk: &args.talk,
    };
    let bound = bound(result, data, &reading, &[], (&limits, &narrator))?;
    limits.listen();
    let source = Source {
        discovery: &bound.opened.discovery,
        model: &bound.model,
        dataset: &bound.dataset,
    };
    let line = args.talk.line(&limits);
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

/// Along every record, until time is up; stretches held out by themselves. A record that cannot be run is told in the page.
fn runs(
    source: &Source,
    document: &Document,
    line: &Line,
    (limits, narrator): (&Limits, &Narrator),
) -> Vec<Along> {
    let mut runs = Vec::new();
    for (trajectory, record) in source.dataset.trajectories.iter().enumerate() {
        for (held, window) in report::stretches(document, record) {
            if !runs.is_empty() && limits.go_on().is_break() {
                return runs;
            }
            let mut go_on = watch(&record.name, line, limits);
            let options = Options {
                window,
                ..Options::default()
            };
            let run = simulate::simulate(source, trajectory, &options, &mut go_on);
            runs.push(Along {
                trajectory,
                held,
                run: run.map_err(|d| d.message),
            });
            narrator.done(&format!("run along {}", record.name));
        }
    }
    runs
}
