//! Samples + libraries → [`Discovery`]: the solver proposes, a criterion decides, the coefficients are polished, the evidence weighed.
//!
//! Knows solvers only by their trait. Never reads or prints.

mod constraints;
mod contradiction;
mod dependent;
mod discovery;
mod doubts;
mod equation;
mod form;
mod identifiability;
mod joint;
mod joint_doubts;
mod joint_search;
mod memory;
mod path;
mod pools;
mod prepared;
mod proof;
mod relation;
mod rows;
mod strain;
mod strays;
mod subset;
mod successive;
mod support;
mod tied_proof;
mod tied_support;
mod ties;
mod together;
mod trust;
mod unfitted;
mod watch;
mod weak;
mod weights;
mod witness;

use crate::data::{Dataset, Origin, Samples};
use crate::dictionary::BadValue;
use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::{Model, RightSide};
use crate::library::{self, Library, known_terms};
use crate::solve::{SOLVERS, Solver};
use crate::term::Term;

pub use discovery::{
    ChannelFit, Discovery, Equation, Evidence, Failed, FoundTerm, HeldOut, InputDelay, OtherLaw,
    PathKnot, Proof, Rearranged, Reason, Status, Together, Variable,
};
pub use doubts::tie;
pub use form::{Form, Rate, Row};
pub use identifiability::{
    Alike, Cause, Excitation, Finding, Identifiability, Isometry, Leverage, Pair, Relation,
};
pub use joint::{Fitted, discover_jointly, joint};
pub use rows::{Split, SplitMix, split};
pub use ties::check_constraints;
pub use trust::{Halves, MARKS, Mark, Marks, Nearest, Stretches, Trust, Without};
pub use unfitted::nothing_fits;
pub use watch::{Stage, Step, Stop, Watch, unweighed};
pub use weights::Weights;
pub use witness::{Verification, VerifiedProof, Witness};

/// What an equation is found from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The program's choice.
    #[default]
    Auto,
    /// Trajectory and all equations together, by their likelihood.
    Joint,
    /// Estimated derivatives, instant by instant.
    Regression,
    /// Integrals against test functions, so that noise is never differentiated.
    Weak,
}

/// What `--method` takes.
pub const METHODS: &[(&str, Method)] = &[
    ("auto", Method::Auto),
    ("joint", Method::Joint),
    ("regression", Method::Regression),
    ("weak", Method::Weak),
];

impl Method {
    /// Its name; empty if the choice was left to the program.
    pub fn chosen(self) -> &'static str {
        let chosen = METHODS.iter().filter(|_| self != Method::Auto);
        chosen
            .into_iter()
            .find(|(_, m)| *m == self)
            .map_or("", |(n, _)| n)
    }
}

/// How to look.
#[derive(Clone, Copy)]
pub struct Options {
    pub method: Method,
    pub solver: &'static dyn Solver,
    /// Rows to draw at random; the rest is held out.
    pub samples: Option<usize>,
    /// Seed of that draw.
    pub seed: u64,
    /// Most bytes that one equation's Φ may take.
    pub memory: u64,
    /// Whether the whole path of each equation is wanted.
    pub path: bool,
    /// Whether readings far from what the laws say have no weight.
    pub robust: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            method: Method::Auto,
            solver: SOLVERS[0],
            samples: None,
            seed: 0,
            memory: library::MEMORY,
            path: false,
            robust: false,
        }
    }
}

/// A term that the data cannot evaluate: which equation asked for it, and where it fails.
pub type Unevaluable = (usize, Box<BadValue>);

/// Why there is no discovery at all.
#[derive(Clone, Debug)]
pub enum Refusal {
    Unevaluable(Unevaluable),
    /// The data contradict the constraints.
    Contradiction(Diagnostic),
}

/// Finds every equation of the model. `libraries` has one entry an equation, `None` for those that are known. Equations that
/// constraints connect are solved together. Where `watch` ends the work, the equations found so far stand, and the others are
/// listed as failed.
///
/// ```
/// use std::ops::ControlFlow;
/// use sidc::data::Dataset;
/// use sidc::discover::{Options, Status, discover};
/// use sidc::pipeline::Program;
///
/// let program = Program::compile("decay.sid", "state x\ndx ~ powers(x; 3)\n")?;
/// let x: Vec<f64> = (0..40).map(|k| 2.0 * (-0.1 * f64::from(k)).exp()).collect();
/// let dx: Vec<f64> = x.iter().map(|x| -x).collect();
/// let time: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
/// let samples = program.samples(&time, &[("x", &x), ("dx", &dx)])?;
///
/// // Everything is measured, so there is no dataset to ask for more.
/// let data = (&Dataset::default(), &samples);
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let found = discover(&program.model, &program.libraries, data, &Options::default(), go_on);
/// let found = found.map_err(|_| "a term has no value")?;
/// let equation = &found.equations[0];
/// assert_eq!((equation.status, equation.terms.len()), (Status::Pass, 1));
/// assert!((equation.terms[0].coefficient + 1.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Terms without a finite value on the data, one an equation; constraints that the data contradict.
pub fn discover(
    model: &Model,
    libraries: &[Option<Library>],
    (dataset, samples): (&Dataset, &Samples),
    options: &Options,
    watch: Watch,
) -> Result<Discovery, Vec<Refusal>> {
    let mut discovery = Discovery::of(model);
    let mut done: Vec<Option<Result<Equation, Failed>>> = vec![None; model.equations.len()];
    let (mut bad, mut doubts) = (Vec::new(), Vec::new());
    let mut watcher = watch::Watcher::new(watch);
    let tied = ties::ties(model, libraries);
    let groups = ties::groups(&tied, model.equations.len());
    let task = |i: usize| -> Option<(usize, equation::Task)> {
        let equation = model.equations.get(i)?;
        let task = equation::Task {
            target: equation.target,
            known: fixed_terms(&equation.right),
            library: libraries.get(i)?.as_ref()?,
            model,
            dataset,
            samples,
            options,
        };
        Some((i, task))
    };
    if options.method == Method::Weak {
        let alone = (0..model.equations.len()).filter(|i| !groups.iter().any(|g| g.contains(i)));
        match weak::Together::new(alone.filter_map(task)) {
            Ok(together) => {
                for (i, found) in together.run(&discovery, &mut watcher) {
                    done[i] = Some(found);
                }
            }
            Err(values) => bad.extend(values.into_iter().map(Refusal::Unevaluable)),
        }
    }
    for (i, equation) in model.equations.iter().enumerate() {
        if done.get(i).is_some_and(Option::is_some) {
            continue;
        }
        let Some((_, alone)) = task(i) else {
            let known = fixed_terms(&equation.right);
            done[i] = Some(Ok(stated(equation.target, known)));
            continue;
        };
        let Some(members) = groups.iter().find(|g| g.contains(&i)) else {
            watcher.turn_to(i);
            match alone.run(&discovery, &mut watcher) {
                Ok(found) => done[i] = Some(found),
                Err(value) => bad.push(Refusal::Unevaluable((i, value))),
            }
            continue;
        };
        if members.first() != Some(&i) {
            continue;
        }
        let among = |t: &&ties::Tied| t.row.entries.iter().any(|e| members.contains(&e.0));
        let group = together::Group {
            tasks: members.iter().filter_map(|m| task(*m)).collect(),
            tied: tied.iter().filter(among).collect(),
        };
        match group.run(&discovery, &mut watcher) {
            Ok(concluded) => {
                doubts.extend(concluded.doubts);
                for (place, found) in concluded.done {
                    done[place] = Some(found);
                }
            }
            Err(refusals) => bad.extend(refusals),
        }
    }
    if !bad.is_empty() {
        return Err(bad);
    }
    for found in done.into_iter().flatten() {
        match found {
            Ok(equation) => discovery.equations.push(equation),
            Err(failed) => discovery.failed.push(failed),
        }
    }
    together::attach(&mut discovery, &doubts);
    let untied = |i: &usize| !groups.iter().any(|g| g.contains(i));
    let untied = (0..model.equations.len()).filter(untied);
    let again = relation::Again {
        tasks: untied.filter_map(|i| Some(task(i)?.1)).collect(),
        watcher: &mut watcher,
    };
    relation::judge(&mut discovery, samples, Some(again));
    dependent::judge(&mut discovery, &states_of(model, samples));
    constraints::judge(&mut discovery, model);
    Ok(discovery)
}

/// The states that were measured.
fn states_of(model: &Model, samples: &Samples) -> Vec<dependent::Measured> {
    let state = |s: crate::term::Signal| {
        s.der == 0
            && model
                .equations
                .iter()
                .any(|e| e.target.var == s.var && e.target.der > 0)
    };
    let columns = samples.columns.iter().filter(|c| state(c.signal));
    columns
        .filter_map(|c| match &c.origin {
            Origin::Measured { noise } => Some(dependent::Measured {
                signal: c.signal,
                values: c.values.clone(),
                noise: noise.unwrap_or(0.0),
            }),
            Origin::Estimated { .. } => None,
        })
        .collect()
}

/// The terms that the model itself gives an equation.
fn fixed_terms(right: &RightSide) -> Vec<(f64, Term)> {
    match right {
        RightSide::Known(e) => known_terms([e]),
        RightSide::Search { known, .. } => known_terms(known.iter().map(|(e, _)| e)),
    }
}

fn stated(target: crate::term::Signal, terms: Vec<(f64, Term)>) -> Equation {
    Equation {
        target,
        terms: terms.into_iter().map(fixed).collect(),
        status: Status::Known,
        reasons: Vec::new(),
        evidence: None,
        path: Vec::new(),
    }
}

fn fixed((coefficient, term): (f64, Term)) -> FoundTerm {
    FoundTerm {
        term,
        coefficient,
        fixed: true,
        standard_error: None,
        trust: None,
    }
}
