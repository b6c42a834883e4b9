//! Program + data → measured signals: the second stage.
//!
//! In: a program, tables, and which rows to use. Out: the signals on common rows or the joint problem of all equations, and diagnostics. Finds no equation.

use sidc_data as data;
use sidc_data::{Dataset, HoldOut, InputValue, Provenance, Samples, Table};
use sidc_discover as discover;
use sidc_discover::trajectory::Problem;
use sidc_discover::unknown_constants;
use sidc_discover::{Method, TargetCopy};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::{Equation, Model, Var, VarKind};
use sidc_lang::source::Sources;
use sidc_lang::term::{Language, Signal, SignalNames, VarId};
use sidc_progress::{Activity, Observer};

use sidc_system::discovery::Discovery;

use super::constant_estimation;
use super::delays;
use super::program::{Program, Staged, finish, needed};
use crate::data::Data;
use crate::options::Options;

/// A program's signals on common rows.
pub struct Measured {
    pub dataset: Dataset,
    /// The dataset with stated delays removed, for equations found one by one; `None` if that changes nothing.
    acting: Option<Dataset>,
    /// The held-out data: equations are not found from them, but run on them.
    pub held: Dataset,
    /// The held-out data in words, for messages.
    pub held_out: Vec<String>,
    /// Empty if the equations are estimated jointly.
    pub samples: Samples,
    /// Values of the unknown constants at other minima of the criterion.
    pub(super) other_constants: Vec<Vec<f64>>,
    /// The joint problem of all equations and their trajectory, if they are estimated that way.
    pub joint: Option<Problem>,
    /// Which signals were measured and which estimated.
    pub report: Vec<Provenance>,
    /// The program without candidates that only restate their target; `None` if there are none.
    narrowed: Option<Program>,
}

/// Data of tables that were read from files.
pub fn from_tables(tables: Vec<Table>, params: Vec<(String, Vec<f64>)>) -> Data {
    Data {
        tables,
        params,
        ..Data::default()
    }
}

/// Program + data → samples of every signal in the equations, or the joint problem of all equations and their trajectory. If `observer` ends the work, there
/// are no rows.
pub fn measure(
    program: &Program,
    data: &Data,
    options: &Options,
    sources: &mut Sources,
    observer: &mut dyn Observer,
) -> Staged<Measured> {
    let model = &program.model;
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
    diagnostics.extend(delays::check(model, &dataset));
    if diagnostics.iter().any(Diagnostic::is_error) {
        return (None, diagnostics);
    }
    let stated = Discovery::of(model);
    let at_instants = stated.without_delays(&dataset, InputValue::AtInstant);
    let first = model.equations.first().map_or(Signal::TIME, |e| e.target);
    let signal = &model.name(first);
    let together = |program: &Program, search: &discover::Options, observer: &mut dyn Observer| {
        let _ = observer.hear(Activity::Preparing { signal });
        discover::joint(model, &program.libraries, &dataset, search, observer)
    };
    let search = &options.search;
    let mut joint = together(program, search, observer);
    let (samples, mut found, report) = match &joint {
        Ok(_) => Default::default(),
        // A hidden state has no readings to differentiate.
        Err(_) if model.hidden_states().next().is_some() => Default::default(),
        Err(_) => {
            let acting = at_instants.as_ref().unwrap_or(&dataset);
            data::samples(model, acting, &needed(program), observer)
        }
    };
    if search.chooses_way() && found.iter().any(|d| d.code == "no-samples") {
        // A trajectory can be estimated even if no row is complete, or readings are too sparse for derivatives.
        let method = Method::Joint;
        let jointly = discover::Options { method, ..*search };
        joint = together(program, &jointly, observer).or(joint);
        found.retain(|d| !d.is_error() || joint.is_err());
    }
    let mut copies = match &joint {
        Ok(problem) => problem.target_copies(),
        Err(_) => copies_in_samples(program, &samples),
    };
    copies.retain(|c| !is_required(program, c));
    let narrowed = (!copies.is_empty()).then(|| program.without(&copies));
    if let Some(program) = narrowed.as_ref().filter(|_| joint.is_ok()) {
        let method = Method::Joint;
        joint = together(program, &discover::Options { method, ..*search }, observer);
    }
    diagnostics.extend(copies.iter().map(|c| left_out(program, c)));
    if let Err(why) = &joint {
        if let Some((_, hidden)) = model.hidden_states().next() {
            diagnostics.push(not_hidden(model, hidden, &why.because));
        } else if !model.resets.is_empty() {
            diagnostics.push(not_with_resets(&why.because));
        } else if !model.per_run.is_empty() {
            diagnostics.push(not_per_run(model, &why.because));
        } else if let Some(sought) = delays::search_unavailable(model, &why.because) {
            diagnostics.push(sought);
        } else if search.method == Method::Joint {
            diagnostics.push(not_joint(&why.because));
        } else if search.robust {
            diagnostics.push(not_robust(&why.because));
        } else if why.weaker {
            diagnostics.push(weaker_method(&why.because));
        }
    }
    if search.method == Method::Weak
        && let Some(name) = growing(model)
    {
        diagnostics.push(share_unused(&name));
    }
    let estimated = |s: &Signal| joint.as_ref().is_ok_and(|problem| problem.holds(*s));
    let mut noisy = model.noisy_inputs().map(|(s, _)| s);
    if let Some(unused) = noisy.find(|s| !estimated(s)) {
        diagnostics.push(input_noise_unused(&model.name(unused)));
    }
    let mut lasting = model.autocorrelated_noise();
    if (joint.is_err() || model.noisy_inputs().any(|(s, _)| estimated(&s)))
        && let Some(name) = lasting.next()
    {
        diagnostics.push(memory_unused(&model.name(name)));
    }
    if !model.unknowns.is_empty() {
        let method = Method::Joint;
        let jointly = discover::Options { method, ..*search };
        // Where all equations are given, regression knows as little of constants that only act together.
        let other = (joint.is_err() && program.libraries.iter().all(Option::is_none))
            .then(|| together(program, &jointly, observer));
        let problem = joint
            .as_ref()
            .ok()
            .or(other.as_ref().and_then(|o| o.as_ref().ok()));
        diagnostics.extend(problem.map_or_else(Vec::new, |p| {
            discover::structurally_unidentifiable(model, p)
        }));
    }
    let joint = joint.ok();
    diagnostics.extend(found);
    let acting = match &joint {
        Some(_) => None,
        None => stated.without_delays(&dataset, InputValue::OverStep),
    };
    let mut measured = Measured {
        dataset,
        acting,
        held,
        held_out: in_words(&hold_out, data),
        samples,
        other_constants: Vec::new(),
        joint,
        report,
        narrowed,
    };
    let data = (measured.acting(), &measured.samples);
    if let Some(found) = constant_estimation::estimate(program, data, options, observer) {
        measured.set_constants(model, &found.values);
        measured.other_constants = found.others;
    }
    finish(measured, diagnostics)
}

impl Measured {
    /// Sets the values of the unknown constants.
    fn set_constants(&mut self, model: &Model, values: &[f64]) {
        let sought = unknown_constants::sought(model, &self.samples);
        self.samples = unknown_constants::with_values(&self.samples, &sought, values);
        let signals = unknown_constants::named_values(&self.dataset, &sought, values);
        let acting = self.acting.iter_mut();
        for dataset in acting.chain([&mut self.dataset, &mut self.held]) {
            *dataset = dataset.with_constants(&signals);
        }
    }
}

fn copies_in_samples(program: &Program, samples: &Samples) -> Vec<TargetCopy> {
    let equations = program.model.equations.iter().zip(&program.libraries);
    let copies = equations
        .enumerate()
        .flat_map(|(place, (equation, library))| {
            let of = |l| discover::copies_in_samples(place, equation.target, l, samples);
            library.as_ref().map(of).unwrap_or_default()
        });
    copies.collect()
}

fn left_out(program: &Program, copy: &TargetCopy) -> Diagnostic {
    let target = program.model.equations.get(copy.equation).map(|e| e.target);
    let target = target.map_or_else(String::new, |t| program.model.name(t));
    let term = Language(&program.model).term(&copy.term);
    Diagnostic::warning(
        "target-copied",
        format!("{term} is {target} itself in other words, along these data: it is left out of the library"),
    )
    .fact(format!("it would explain {target} by {target}, whatever the law is"))
    .help(format!("remove {term} from the library of {target}"))
}

/// What is held out, in the words of the command line.
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

/// Required terms are never left out.
fn is_required(program: &Program, copy: &TargetCopy) -> bool {
    let library = program
        .libraries
        .get(copy.equation)
        .and_then(Option::as_ref);
    library.is_some_and(|l| l.required().contains(&copy.slot))
}

/// Derivatives estimated across a jump are those of no law.
fn not_with_resets(why: &str) -> Diagnostic {
    let message = format!(
        "states jump (`when`), so the equations are estimated together with the trajectory, and here they are not: {why}"
    );
    Diagnostic::error("resets-not-estimated", message)
        .help("leave out what asks for another method, or the lines with `when`")
}

fn not_per_run(model: &Model, why: &str) -> Diagnostic {
    let message = format!(
        "coefficients that differ from run to run are estimated together with the trajectory, and here they are not: {why}"
    );
    let d = Diagnostic::error("per-run", message);
    let d = match model.per_run.first() {
        Some(first) => d.at(first.span, "declared here"),
        None => d,
    };
    d.help("leave --method, --samples and --path out; in discrete time and with constraints, identify each run alone")
}

fn not_hidden(model: &Model, hidden: &Var, why: &str) -> Diagnostic {
    let message = format!(
        "{} is hidden, so the equations are estimated together with the trajectory, and here they are not: {why}",
        hidden.name
    );
    let d = Diagnostic::error("hidden-not-estimated", message);
    let d = match hidden.span {
        Some(span) => d.at(span, "declared here"),
        None => d,
    };
    let kind = |e: &Equation| model.var(e.target.var).map(|v| v.kind);
    match model.equations.iter().any(|e| kind(e) == Some(VarKind::Output)) {
        true => d.help("declare what is read as a state, with an equation for its derivative: outputs show no hidden state"),
        false => d.help("leave --method, --samples and --path out"),
    }
}

fn not_robust(why: &str) -> Diagnostic {
    Diagnostic::warning(
        "robust-unused",
        format!("--robust has no effect: the equations are not estimated together with their trajectory, because {why}"),
    )
    .help("readings are left out where --method is joint")
}

/// The first signal with noise declared to grow with its value.
fn growing(model: &Model) -> Option<String> {
    let vars = (0..).map(VarId).zip(&model.vars);
    let mut sensors = vars.flat_map(|(id, v)| v.noise.iter().map(move |(der, n)| (id, *der, n)));
    let (id, der, _) = sensors.find(|(_, _, noise)| noise.grows())?;
    Some(model.name(Signal::derivative(id, der)))
}

fn share_unused(name: &str) -> Diagnostic {
    Diagnostic::warning(
        "share-unused",
        format!("the weak form takes the noise of {name} to be the same at every value: its root mean square along the data"),
    )
    .help("leave --method to the program: the joint estimate weighs each reading by its own noise")
}

fn memory_unused(name: &str) -> Diagnostic {
    Diagnostic::warning(
        "memory-unused",
        format!(
            "the noise of {name} counts as white: only the joint estimate knows noise that lasts"
        ),
    )
    .help("say `--method joint`")
}

fn input_noise_unused(name: &str) -> Diagnostic {
    Diagnostic::warning(
        "input-noise-unused",
        format!("{name} is taken as it is read: only the joint estimate knows noise of inputs, and only of those that are held between samples"),
    )
    .help("say `hold` if the input is held; otherwise its noise makes its coefficients too small")
}

fn weaker_method(why: &str) -> Diagnostic {
    Diagnostic::warning(
        "weaker-method",
        format!(
            "the readings are noisy, and the equations are found by regression of derivatives, not together with their \
             trajectory, because {why}"
        ),
    )
    .help("derivatives of noisy readings hide terms and move coefficients: change what stands in the way, or expect less")
}

impl Measured {
    /// The records with the delays that the model states removed, so that inputs are as they act and states as they are.
    pub(super) fn acting(&self) -> &Dataset {
        self.acting.as_ref().unwrap_or(&self.dataset)
    }

    /// The program with the candidates that are searched.
    pub(super) fn searched<'a>(&'a self, program: &'a Program) -> &'a Program {
        self.narrowed.as_ref().unwrap_or(program)
    }

    /// The number of rows or samples that equations are found from.
    pub fn rows(&self) -> usize {
        self.joint
            .as_ref()
            .map_or(self.samples.len(), Problem::samples)
    }
}
