//! `sidc check MODEL [DATA…]`: what the model means, how large it is, what the data lack.

use std::ops::ControlFlow;
use std::path::PathBuf;

use super::answer;
use super::inputs::{self, Inputs, Notes};
use super::limits::{self, Limits};
use super::progress::{Line, Work};
use super::{Failure, output, status};
use sidc::pipeline;
use sidc::pipeline::{Program, Rows};
use sidc_discover::Options;
use sidc_lang::library;
use sidc_lang::library::{Block, Library, readable, readable_bytes};
use sidc_lang::model::Model;
use sidc_lang::source::Sources;
use sidc_lang::term::{Language, Signal, SignalNames, VarId};
use sidc_progress::Activity;

/// Check a model, and whether the data fit it
#[derive(clap::Args)]
#[command(after_help = super::examples::CHECK)]
pub struct Args {
    /// A model (.sid) and any data files
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// List every candidate term of every equation
    #[arg(long)]
    terms: bool,
    /// Constant parameters: one value a trajectory, or one for all
    #[arg(long = "param", value_parser = super::values::parameter)]
    params: Vec<(String, Vec<f64>)>,
    /// Most memory for all tables, and for all libraries: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = limits::memory, default_value = limits::MEMORY)]
    memory_limit: u64,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let files = Inputs::sort(&args.files)?;
    let mut sources = Sources::default();
    let file = inputs::model(files.model()?, &mut sources)?;
    let compiled = pipeline::compile(file, &sources, args.memory_limit);
    let program = inputs::report(compiled, &sources, Notes::Full)?;
    let mut text = describe(&program);
    if args.terms {
        text.push_str(&terms(&program));
    }
    if !files.data.is_empty() {
        let line = Line::start(true, &Limits::start(None));
        let tables = inputs::tables(&files.data, args.memory_limit, &mut sources, &line)?;
        let staged = pipeline::measure(
            &program,
            &tables,
            &args.params,
            (&Rows::default(), &Options::default()),
            &mut sources,
            &mut |activity: Activity| {
                if let Activity::Preparing { signal } = activity {
                    line.show(Work::Preparing(signal.into()));
                }
                ControlFlow::Continue(())
            },
        );
        drop(line);
        let measured = inputs::report(staged, &sources, Notes::Full)?;
        text.push_str(&format!(
            "{} from {}\n",
            counted(measured.rows(), "row", "rows"),
            answer::trajectories(&measured)
        ));
        text.push_str(&answer::signals_text(&program, &measured));
    }
    output::show(&text)?;
    // The process ends here; freeing every term of a large library one by one would be a good part of its time.
    std::mem::forget(program);
    Ok(status::PASS)
}

/// One line an equation: what it asks, how many terms.
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
            Some(l) => format!("{target} ~ {}; {}\n", terms_of(program, l), storage(l)),
        });
    }
    text
}

/// `units: y m, F N, t s; targets ddy m/s^2`, of what has one.
fn units(model: &Model) -> String {
    const SHOWN: usize = 24;
    let list = |signals: &mut dyn Iterator<Item = Signal>| {
        let mut each =
            signals.filter_map(|s| Some(format!("{} {}", model.name(s), model.unit(s)?)));
        let mut names: Vec<String> = each.by_ref().take(SHOWN).collect();
        names.extend(each.next().map(|_| "…".into()));
        names.join(", ")
    };
    // Time comes last: it has a unit wherever anything has.
    let ids = (1..model.vars.len()).chain([0]).map(|i| VarId(i as u16));
    let variables = list(&mut ids.map(Signal::new));
    let targets = list(&mut model.equations.iter().map(|e| e.target));
    match (variables.is_empty(), targets.is_empty()) {
        (true, _) => String::new(),
        (false, true) => format!("units: {variables}\n"),
        (false, false) => format!("units: {variables}; targets {targets}\n"),
    }
}

/// `3,281 candidate terms of 6,561 (symmetry y, theta, F; degree ≤ 4)`
fn terms_of(program: &Program, library: &Library) -> String {
    let name = if library.len() == 1 { "term" } else { "terms" };
    let mut text = format!("{} candidate {name}", readable(library.len() as u128));
    if let Some(by) = library::restrictions(&program.model) {
        if let Some(before) = library.before() {
            text.push_str(&format!(" of {}", readable(before)));
        }
        text.push_str(&format!(" ({by})"));
    }
    text
}

/// `stored as 81 × 81 products: Φ takes 130 kB per 100 rows, and 52 kB`
fn storage(library: &Library) -> String {
    let bytes = |n: usize| readable_bytes(8 * n as u128);
    let (lists, products): (Vec<&Block>, Vec<&Block>) =
        library.blocks().iter().partition(|b| b.is_list());
    let listed: usize = lists.iter().map(|b| b.slots()).sum();
    if products.is_empty() {
        return format!("Φ takes {} per 100 rows", bytes(100 * listed));
    }
    let sides = |b: &&Block| (b.left.len(), b.right.len());
    let mut parts: Vec<String> = match products.len() {
        1..=3 => products
            .iter()
            .map(sides)
            .map(|(l, r)| format!("{} × {}", readable(l as u128), readable(r as u128)))
            .collect(),
        n => vec![readable(n as u128)],
    };
    if listed > 0 {
        parts.insert(0, format!("{} listed", readable(listed as u128)));
    }
    let factors: usize = products.iter().map(sides).map(|(l, r)| l + r).sum();
    format!(
        "stored as {} products: Φ takes {} per 100 rows, and {}",
        parts.join(" + "),
        bytes(100 * (listed + factors)),
        bytes(library.slots())
    )
}

/// `1 table`, `2 tables`
pub(super) fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
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
