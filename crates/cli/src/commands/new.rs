//! `sidc new DATA`: a first model for a table.

use std::path::PathBuf;

use crate::exit_status;
use crate::failure::Failure;
use crate::inputs::tables;
use crate::monitoring::monitor::Monitor;
use crate::option_values::quantities;
use crate::outputs::{diagnostics, files, paths};
use sidc_data as data;
use sidc_data::draft::{ChosenRoles, NoDraft, draft};
use sidc_data::{Table, TooLarge};
use sidc_lang as lang;
use sidc_lang::diagnostic::{Diagnostic, did_you_mean};
use sidc_lang::source::{Sources, printable};

const EXAMPLES: &str = "Examples:
  sidc new data.csv                       print a first model of the table
  sidc new data.csv --input motor         a column that is a command, whatever it looks like
  sidc new data.csv -o model.sid          write it, then:
  sidc identify model.sid data.csv";

/// Write a first model of a table, with comments: states, orders, angles, inputs
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// A data file
    data: PathBuf,
    /// Write the model here instead of on standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Replace the model that is there
    #[arg(long)]
    force: bool,
    /// A column that is time, by its header
    #[arg(long, value_name = "COLUMN")]
    time: Option<String>,
    /// A column that tells runs apart
    #[arg(long, value_name = "COLUMN")]
    run: Option<String>,
    /// Columns that act from outside: --input motor,V_IN
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',')]
    input: Vec<String>,
    /// Columns that the equations are about
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',')]
    state: Vec<String>,
    /// Most memory for the table: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = quantities::memory, default_value = quantities::MEMORY)]
    memory_limit: u64,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let mut sources = Sources::default();
    let data = std::slice::from_ref(&args.data);
    files::check_writable(args.output.as_deref(), data)?;
    if let Some(path) = args
        .output
        .as_deref()
        .filter(|p| p.is_file() && !args.force)
    {
        return Err(Failure::new(format!(
            "error[file-exists]: {} is there already, and may have been edited\n  = help: name another file, or replace it with --force",
            paths::shown(path)
        )));
    }
    let monitor = Monitor::plain();
    let tables = tables::read(data, args.memory_limit, &mut sources, &monitor)?.tables;
    let name = paths::short_name(&args.data);
    let chosen = ChosenRoles {
        time: args.time.clone(),
        run: args.run.clone(),
        inputs: args.input.clone(),
        states: args.state.clone(),
    };
    let drafted = tables
        .first()
        .map_or(Err(NoDraft::NoState), |t| draft(t, &chosen));
    let text = drafted.map_err(|why| match why {
        NoDraft::NoState => nothing(&name, &tables, &mut sources),
        NoDraft::NoColumn(column, headers) => no_column(&name, &column, &headers),
        NoDraft::TooLarge(large) => too_large(&large),
    })?;
    let mut sources = Sources::default();
    let file = sources.add(name, text.as_str());
    let text = lang::format(file, &text).map_err(|found| diagnostics::failure(&found, &sources))?;
    files::write_or_print(args.output.as_deref(), &text)?;
    if let Some(model) = &args.output {
        let word = |path: &PathBuf| printable(&paths::quoted(&path.to_string_lossy()));
        eprintln!("next: sidc identify {} {}", word(model), word(&args.data));
    }
    Ok(exit_status::PASS)
}

fn no_column(name: &str, column: &str, headers: &[String]) -> Failure {
    let near = did_you_mean(column, headers.iter().map(String::as_str));
    let listed: Vec<String> = headers
        .iter()
        .map(|h| format!("\"{}\"", printable(h)))
        .collect();
    let help = match near {
        Some(near) => format!("did you mean \"{}\"?", printable(near)),
        None => "give a header as it stands in the table".into(),
    };
    Failure::new(format!(
        "error[missing-column]: {name} has no column \"{}\" that can be used\n  = columns: {}\n  = help: {help}",
        printable(column),
        listed.join(", ")
    ))
}

fn too_large(large: &TooLarge) -> Failure {
    let topics: Vec<String> = large.topics().iter().map(|t| printable(t)).collect();
    Failure::new(format!(
        "error[table-too-large]: {}\n  = topics: {}\n  = help: name the columns that matter: --state TOPIC_FIELD --input TOPIC_FIELD",
        printable(&large.text()),
        topics.join(", ")
    ))
}

/// Why there is no model: cells that are not numbers, or no column that changes.
fn nothing(name: &str, tables: &[Table], sources: &mut Sources) -> Failure {
    let faults = |t: &Table| {
        let columns: Vec<usize> = (0..t.headers().len()).collect();
        data::bad_cells(t, &columns, sources)
    };
    let faults: Vec<Diagnostic> = tables.iter().flat_map(faults).collect();
    if !faults.is_empty() {
        return diagnostics::failure(&faults, sources);
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
