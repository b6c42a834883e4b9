//! Program + data → measured: the second stage.
//!
//! In: a program, tables, and which rows to use. Out: the signals on common rows, or the problem of all equations together, and
//! diagnostics. Finds no equation.

use sidc_data as data;
use sidc_data::{Dataset, HoldOut, Provenance, Samples, Table};
use sidc_discover as discover;
use sidc_discover::Method;
use sidc_discover::trajectory::Problem;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, SignalNames};
use sidc_progress::{Activity, Observer};

use super::program::{Program, Staged, finish, needed};
use crate::data::Data;
use crate::options::Options;

/// A program's signals on common rows.
pub struct Measured {
    pub dataset: Dataset,
    /// What is held out: equations are not found from it, but run on it.
    pub held: Dataset,
    /// The same in words, for messages.
    pub held_out: Vec<String>,
    /// Empty where all equations are found together.
    pub samples: Samples,
    /// The problem of all equations together with their trajectory, where they are found that way.
    pub joint: Option<Problem>,
    /// What was measured and what was estimated.
    pub report: Vec<Provenance>,
}

/// Tables that were read from files, as data.
pub fn from_tables(tables: Vec<Table>, params: Vec<(String, Vec<f64>)>) -> Data {
    Data { tables, params }
}

/// Program + data → samples of every signal that the equations mention, or the problem of all equations together with their
/// trajectory. If `observer` ends the work, there are no rows.
pub fn measure(
    program: &Program,
    data: &Data,
    options: &Options,
    sources: &mut Sources,
    observer: &mut dyn Observer,
) -> Staged<Measured> {
    let Program { model, libraries } = program;
    let (mut dataset, mut diagnostics) = data::bind(model, &data.tables, &data.params, sources);
    if diagnostics.iter().any(Diagnostic::is_error) {
        return (None, diagnostics);
    }
    diagnostics.extend(data::keep_window(&mut dataset, options.window));
    if diagnostics.iter().any(Diagnostic::is_error) {
        return (None, diagnostics);
    }
    let hold_out = options.holds_out();
    let held = match data::hold_out(&mut dataset, &hold_out) {
        Ok(held) => held,
        Err(fault) => {
            diagnostics.push(fault);
            return (None, diagnostics);
        }
    };
    let first = model.equations.first().map_or(Signal::TIME, |e| e.target);
    let signal = &model.name(first);
    let together = |search: &discover::Options, observer: &mut dyn Observer| {
        let _ = observer.hear(Activity::Preparing { signal });
        discover::joint(model, libraries, &dataset, search, observer)
    };
    let search = &options.search;
    let mut joint = together(search, observer);
    let (samples, mut found, report) = match &joint {
        Ok(_) => Default::default(),
        Err(_) => data::samples(model, &dataset, &needed(program), observer),
    };
    let free = search.method == Method::Auto && search.samples.is_none() && !search.path;
    if free && found.iter().any(|d| d.code == "no-samples") {
        // A trajectory can be estimated from readings that are never complete, or too sparse for derivatives.
        let method = Method::Joint;
        let jointly = discover::Options { method, ..*search };
        joint = together(&jointly, observer).or(joint);
        found.retain(|d| !d.is_error() || joint.is_err());
    }
    if let Err(why) = &joint {
        if search.method == Method::Joint {
            diagnostics.push(not_joint(why));
        } else if search.robust {
            diagnostics.push(not_robust(why));
        }
    }
    let joint = joint.ok();
    diagnostics.extend(found);
    finish(
        Measured {
            dataset,
            held,
            held_out: in_words(&hold_out, data),
            samples,
            joint,
            report,
        },
        diagnostics,
    )
}

/// What is held out, as a command line would say it.
pub(super) fn in_words(hold_out: &HoldOut, data: &Data) -> Vec<String> {
    let run = |place: &usize| data.tables.get(*place).map(|t| t.name.clone());
    let stretches = hold_out.stretches.iter().map(ToString::to_string);
    stretches
        .chain(hold_out.files.iter().filter_map(run))
        .collect()
}

fn not_joint(why: &str) -> Diagnostic {
    Diagnostic::error(
        "no-joint-estimate",
        format!("the equations cannot be estimated together with their trajectory: {why}"),
    )
    .help("leave --method to the program, or take --method regression")
}

fn not_robust(why: &str) -> Diagnostic {
    Diagnostic::warning(
        "robust-unused",
        format!("--robust has no effect: the equations are not estimated together with their trajectory, because {why}"),
    )
    .help("readings are left out where --method is joint")
}

impl Measured {
    /// Rows or samples that equations are found from.
    pub fn rows(&self) -> usize {
        self.joint
            .as_ref()
            .map_or(self.samples.len(), Problem::samples)
    }
}
