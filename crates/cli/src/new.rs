//! `sidc new DATA`: a first model of a table.

use std::path::PathBuf;

use super::limits::{self, Limits};
use super::progress::Line;
use super::{Failure, inputs, output, status};
use sidc_data as data;
use sidc_data::Table;
use sidc_data::draft::draft;
use sidc_lang as lang;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::Sources;

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
    output::ready(args.output.as_deref(), data)?;
    let tables = inputs::tables(data, args.memory_limit, &mut sources, &line)?;
    drop(line);
    let name = inputs::short_name(&args.data);
    let text = tables.first().and_then(draft);
    let text = text.ok_or_else(|| nothing(&name, &tables, &mut sources))?;
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

/// Why there is no model: cells that are no numbers, or numbers that do not move.
fn nothing(name: &str, tables: &[Table], sources: &mut Sources) -> Failure {
    let faults = |t: &Table| {
        let columns: Vec<usize> = (0..t.headers().len()).collect();
        data::bad_cells(t, &columns, sources)
    };
    let faults: Vec<Diagnostic> = tables.iter().flat_map(faults).collect();
    if !faults.is_empty() {
        return Failure::new(inputs::render(&faults, sources));
    }
    let nameless = tables.iter().flat_map(Table::headers).any(|h| h.is_empty());
    let help = match nameless {
        true => "a column without a name is left out: write one into the first line",
        false => "a table has a line of headers and, below it, a column for each signal",
    };
    Failure::new(format!(
        "error[no-state]: {name}: no column of numbers that has a name moves, so there is nothing to find a law of\n  = help: {help}"
    ))
}
