//! `sidc check MODEL [DATA…]`: what the model means, how large it is, what the data lack.

use std::path::PathBuf;

use crate::exit_status;
use crate::failure::Failure;
use crate::inputs::files::InputFiles;
use crate::inputs::{tables, texts};
use crate::monitoring::monitor::Monitor;
use crate::option_values::{assignments, quantities};
use crate::outputs::{diagnostics, signals, stdout};
use crate::thresholds::LISTS;
use sidc::Options;
use sidc::pipeline::{self, Program};
use sidc_lang::library;
use sidc_lang::model::Model;
use sidc_lang::source::Sources;
use sidc_lang::term::{Language, Signal, SignalNames, VarId};

const EXAMPLES: &str = "Examples:
  sidc check pendulum.sid                       what the model means: equations, terms, units
  sidc check pendulum.sid data.csv              what is measured, what has to be estimated
  sidc check pendulum.sid --terms               every candidate term by name";

/// Check a model, and whether the data fit it
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// A model (.sid) and any data files
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// List every candidate term of every equation
    #[arg(long)]
    terms: bool,
    /// Constant parameters: one value a trajectory, or one for all
    #[arg(long = "param", value_parser = assignments::parameter)]
    params: Vec<(String, Vec<f64>)>,
    /// Most memory for all tables, and for all libraries: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = quantities::memory, default_value = quantities::MEMORY)]
    memory_limit: u64,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let files = InputFiles::sort(&args.files)?;
    let mut sources = Sources::default();
    let (file, _) = texts::model(files.model()?, &mut sources)?;
    let compiled = pipeline::compile(file, &sources, args.memory_limit);
    let monitor = Monitor::plain();
    let program = diagnostics::report(compiled, &sources, monitor.notes)?;
    let mut text = describe(&program);
    if args.terms {
        text.push_str(&terms(&program));
    }
    if !files.data.is_empty() {
        let read = tables::read(&files.data, args.memory_limit, &mut sources, &monitor)?;
        let data = pipeline::from_tables(read.tables, args.params.clone());
        let mut observer = monitor.observer(&program.model);
        let options = Options::default();
        let staged = pipeline::measure(&program, &data, &options, &mut sources, &mut observer);
        drop(observer);
        let measured = diagnostics::report(staged, &sources, monitor.notes)?;
        text.push_str(&format!(
            "{} from {}\n",
            signals::counted(measured.rows(), "row", "rows"),
            signals::trajectories(&measured)
        ));
        text.push_str(&signals::describe(&program, &measured));
    }
    stdout::print_readable(&text)?;
    // The process ends here, and freeing a large library term by term would take a good part of its time.
    std::mem::forget(program);
    Ok(exit_status::PASS)
}

/// One line per equation: what it looks for, and how many terms it has.
fn describe(program: &Program) -> String {
    let model = &program.model;
    let mut text = String::new();
    if let Some(name) = &model.system {
        text.push_str(&format!("system {name}\n"));
    }
    text.push_str(&units(model));
    for (equation, library) in model.equations.iter().zip(&program.libraries) {
        let target = model.name(equation.target);
        text.push_str(&match library {
            None => format!("{target} is known\n"),
            Some(l) => format!(
                "{target} ~ {}; {}\n",
                library::size(model, l),
                library::storage(l)
            ),
        });
    }
    text
}

/// `units: y m, F N, t s; targets ddy m/s^2`, for signals that have a unit.
fn units(model: &Model) -> String {
    let list = |signals: &mut dyn Iterator<Item = Signal>| {
        let mut each =
            signals.filter_map(|s| Some(format!("{} {}", model.name(s), model.unit(s)?)));
        let mut names: Vec<String> = each.by_ref().take(LISTS.units).collect();
        names.extend(each.next().map(|_| "…".into()));
        names.join(", ")
    };
    // Time comes last: if any signal has a unit, so does time.
    let ids = (1..model.vars.len()).chain([0]).map(|i| VarId(i as u16));
    let variables = list(&mut ids.map(Signal::new));
    let targets = list(&mut model.equations.iter().map(|e| e.target));
    match (variables.is_empty(), targets.is_empty()) {
        (true, _) => String::new(),
        (false, true) => format!("units: {variables}\n"),
        (false, false) => format!("units: {variables}; targets {targets}\n"),
    }
}

fn terms(program: &Program) -> String {
    let mut text = String::new();
    for (equation, library) in program.model.equations.iter().zip(&program.libraries) {
        let Some(library) = library else { continue };
        text.push_str(&format!("{} ~\n", program.model.name(equation.target)));
        for (_, term) in library.terms() {
            text.push_str(&format!("  {}\n", Language(&program.model).term(&term)));
        }
    }
    text
}
