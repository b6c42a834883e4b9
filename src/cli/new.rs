//! `sidc new DATA`: a first model of a table.

use std::path::PathBuf;

use super::limits::{self, Limits};
use super::progress::Line;
use super::{Failure, inputs, output, status};
use crate::draft::draft;
use crate::lang;
use crate::lang::source::Sources;

/// Write a first model of a table, with comments: states, orders, angles, inputs
#[derive(clap::Args)]
#[command(after_help = super::examples::NEW)]
pub struct Args {
    /// A data file
    data: PathBuf,
    /// Write the model here instead of on standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Most memory for the table: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = limits::memory, default_value = limits::MEMORY)]
    memory_limit: u64,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let mut sources = Sources::default();
    let line = Line::start(true, &Limits::start(None));
    let data = std::slice::from_ref(&args.data);
    let tables = inputs::tables(data, args.memory_limit, &mut sources, &line)?;
    drop(line);
    let name = inputs::short_name(&args.data);
    let text = tables
        .first()
        .and_then(draft)
        .ok_or_else(|| nothing(&name))?;
    let mut sources = Sources::default();
    let file = sources.add(name, text.as_str());
    let text = lang::format(file, &text)
        .map_err(|found| Failure::new(inputs::render(&found, &sources)))?;
    match &args.output {
        Some(path) => output::write(path, &text)?,
        None => output::print(&text)?,
    }
    Ok(status::PASS)
}

fn nothing(name: &str) -> Failure {
    Failure::new(format!(
        "error[no-state]: {name}: no column of numbers moves, so there is nothing to find a law of\n  = help: a table has a line of headers and, below it, a column for each signal"
    ))
}
