//! The whole flow on one page: text → model → libraries → samples → discovery.
//!
//! Each stage takes the one before and adds its diagnostics; nothing here reads files or prints.

use sidc_data as data;
use sidc_data::{Dataset, HoldOut, Provenance, Samples, Table, Window};
use sidc_discover as discover;
use sidc_discover::identifiability;
use sidc_discover::trajectory::Problem;
use sidc_discover::{Fitted, Method, Options, Refusal};
use sidc_lang as lang;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::library;
pub use sidc_lang::library::MEMORY;
use sidc_lang::library::{GENERATORS, Library};
use sidc_lang::model::{Equation, Model, RightSide};
use sidc_lang::source::{FileId, Sources};
use sidc_lang::term::{Signal, SignalNames};
use sidc_lang::{GeneratorSignature, Vocabulary};
use sidc_progress::{Activity, Observer};
use sidc_solve::threads;
use sidc_system::discovery::Discovery;
use sidc_system::validate;
use sidc_system::validate::Validation;

mod document;
mod evidence;
mod noise;
mod regression;
mod unevaluable;
mod verification;

pub use document::{reading, signal_entries};
pub use noise::{NoiseFault, set_noise};
pub use regression::Regression;
pub use verification::{verification_work, verify};

/// A checked model with the library of each equation; `None` where the equation is known.
#[derive(Clone, Debug)]
pub struct Program {
    pub model: Model,
    pub libraries: Vec<Option<Library>>,
}

/// A program's signals on common rows.
pub struct Measured {
    pub dataset: Dataset,
    /// What equations are not found from.
    pub held: Dataset,
    /// No rows where all equations are found together.
    pub samples: Samples,
    /// The problem of finding all equations together with the trajectory, where that is the way.
    pub joint: Option<Problem>,
    /// What was measured and what was estimated.
    pub report: Vec<Provenance>,
}

/// Up to so many equations are expanded at once; more would be more threads than cores.
const MAX_THREADS: usize = 8;

/// What a stage gave, if it gave anything, and everything it had to say.
pub type Staged<T> = (Option<T>, Vec<Diagnostic>);

/// The words that the registries add to the language.
pub fn vocabulary() -> Vocabulary {
    Vocabulary {
        generators: GENERATORS
            .iter()
            .map(|g| GeneratorSignature {
                name: g.name(),
                usage: g.usage(),
                discrete_only: g.discrete_only(),
                of_angles: g.of_angles(),
            })
            .collect(),
    }
}

/// Text → program, of which all libraries together take `memory` bytes at most: each equation has an equal share.
pub fn compile(file: FileId, sources: &Sources, memory: u64) -> Staged<Program> {
    let (model, mut diagnostics) = lang::compile(file, sources, &vocabulary());
    let Some(model) = model else {
        return (None, diagnostics);
    };
    let mut libraries = Vec::new();
    for (library, found) in expand_all(&model, memory) {
        // One `let` used by several equations has the same to say about each.
        for d in found {
            if !diagnostics.contains(&d) {
                diagnostics.push(d);
            }
        }
        libraries.push(library);
    }
    if !diagnostics.iter().any(Diagnostic::is_error) {
        diagnostics.extend(discover::check_constraints(&model, &libraries));
    }
    finish(Program { model, libraries }, diagnostics)
}

/// The library of each equation, in order. Start-up is mostly this, so few equations share the cores.
fn expand_all(model: &Model, memory: u64) -> Vec<(Option<Library>, Vec<Diagnostic>)> {
    let expand = |equation: &Equation| match &equation.right {
        RightSide::Search {
            library: Some(written),
            ..
        } => {
            let (library, found) = library::expand(model, equation.target, written, memory);
            (Some(library), found)
        }
        _ => (None, Vec::new()),
    };
    let Some((first, rest)) = model.equations.split_first() else {
        return Vec::new();
    };
    if rest.len() >= MAX_THREADS || threads::available() == 1 {
        return model.equations.iter().map(expand).collect();
    }
    std::thread::scope(|scope| {
        let spawn = |e| scope.spawn(move || expand(e));
        let others: Vec<_> = rest.iter().map(spawn).collect();
        let mut all = vec![expand(first)];
        // A thread that could not finish leaves its equation to this one.
        let joined = others.into_iter().zip(rest);
        all.extend(joined.map(|(handle, e)| handle.join().unwrap_or_else(|_| expand(e))));
        all
    })
}

/// Which rows there are, and which of them equations are not found from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    pub window: Window,
    pub held: HoldOut,
}

/// Program + tables → the problem of all equations together, or samples of every signal that they mention; no rows if
/// the observer ended the work.
pub fn measure(
    program: &Program,
    tables: &[Table],
    params: &[(String, Vec<f64>)],
    (rows, options): (&Rows, &Options),
    sources: &mut Sources,
    observer: &mut dyn Observer,
) -> Staged<Measured> {
    let (mut dataset, mut diagnostics) = data::bind(&program.model, tables, params, sources);
    if diagnostics.iter().any(Diagnostic::is_error) {
        return (None, diagnostics);
    }
    diagnostics.extend(data::keep_window(&mut dataset, rows.window));
    if diagnostics.iter().any(Diagnostic::is_error) {
        return (None, diagnostics);
    }
    let held = match data::hold_out(&mut dataset, &rows.held) {
        Ok(held) => held,
        Err(fault) => {
            diagnostics.push(fault);
            return (None, diagnostics);
        }
    };
    let (model, libraries) = (&program.model, &program.libraries);
    let first = model.equations.first().map_or(Signal::TIME, |e| e.target);
    let signal = &model.name(first);
    let together = |options: &Options, observer: &mut dyn Observer| {
        let _ = observer.hear(Activity::Preparing { signal });
        discover::joint(model, libraries, &dataset, options, observer)
    };
    let mut joint = together(options, observer);
    let (samples, mut found, report) = match &joint {
        Ok(_) => Default::default(),
        Err(_) => data::samples(&program.model, &dataset, &needed(program), observer),
    };
    let free = options.method == Method::Auto && options.samples.is_none() && !options.path;
    if free && found.iter().any(|d| d.code == "no-samples") {
        // Readings that are never complete, or too sparse for derivatives, may do for a trajectory.
        let method = Method::Joint;
        joint = together(&Options { method, ..*options }, observer).or(joint);
        found.retain(|d| !d.is_error() || joint.is_err());
    }
    if let Err(why) = &joint {
        if options.method == Method::Joint {
            diagnostics.push(not_joint(why));
        } else if options.robust {
            diagnostics.push(not_robust(why));
        }
    }
    let joint = joint.ok();
    diagnostics.extend(found);
    finish(
        Measured {
            dataset,
            held,
            samples,
            joint,
            report,
        },
        diagnostics,
    )
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

/// Program + samples → equations with evidence.
pub fn identify(
    program: &Program,
    measured: &Measured,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Discovery, Vec<Diagnostic>> {
    if let Some(problem) = &measured.joint {
        let found = discover::discover_jointly(&program.model, problem, options, &mut *observer);
        let (mut discovery, fitted) = found.unwrap_or_else(|| {
            let nothing = discover::nothing_fits(&program.model, problem);
            (nothing, Fitted::default())
        });
        let found = (&mut discovery, observer);
        evidence::weigh_fitted(program, measured, &fitted, options, found);
        return Ok(discovery);
    }
    let found = discover::discover(
        &program.model,
        &program.libraries,
        (&measured.dataset, &measured.samples),
        options,
        &mut *observer,
    );
    let mut discovery = found.map_err(|bad| {
        bad.into_iter()
            .map(|refusal| match refusal {
                Refusal::Unevaluable((i, value)) => {
                    unevaluable::explain(program, measured, i, &value)
                }
                Refusal::Contradiction(diagnostic) => diagnostic,
            })
            .collect::<Vec<Diagnostic>>()
    })?;
    let rows = identifiability::Rows {
        samples: &measured.samples,
        read: None,
    };
    evidence::weigh(program, rows, None, options, (&mut discovery, observer));
    Ok(discovery)
}

/// What was found, run on the rows used and on those held out; `None` where none were. The observer hears the time reached in a run.
pub fn validate(
    program: &Program,
    measured: &Measured,
    found: &mut Discovery,
    observer: &mut dyn Observer,
) -> Option<Validation> {
    let data = (&measured.dataset, &measured.held);
    let runs = validate::validate((found, &program.model), data, observer)?;
    validate::doubt(&runs, found);
    Some(runs)
}

impl Program {
    /// The place of an equation in the model and its library; `None` if nothing is looked for there.
    fn sought(&self, target: Signal) -> Option<(usize, &Library)> {
        let place = self
            .model
            .equations
            .iter()
            .position(|e| e.target == target)?;
        Some((place, self.libraries.get(place)?.as_ref()?))
    }
}

/// Every signal that some equation mentions, each once, sorted.
pub fn needed(program: &Program) -> Vec<Signal> {
    let mut all = Vec::new();
    for (equation, library) in program.model.equations.iter().zip(&program.libraries) {
        let Some(library) = library else { continue };
        all.push(equation.target);
        all.extend(library.signals());
        if let RightSide::Search { known, .. } = &equation.right {
            known
                .iter()
                .for_each(|(e, _)| e.for_each_signal(&mut |s| all.push(s)));
        }
    }
    all.sort_unstable();
    all.dedup();
    all
}

fn finish<T>(stage: T, diagnostics: Vec<Diagnostic>) -> Staged<T> {
    if diagnostics.iter().any(Diagnostic::is_error) {
        (None, diagnostics)
    } else {
        (Some(stage), diagnostics)
    }
}
