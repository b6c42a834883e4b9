//! Samples + libraries → [`Discovery`]: the solver proposes, a criterion decides, the coefficients are polished, the evidence weighed.
//!
//! Knows solvers only by their trait. Never reads or prints.

mod constraints;
mod discovery;
mod doubts;
mod equation;
mod form;
mod mass;
mod memory;
mod rows;
mod subset;
mod support;
mod watch;
mod weights;

use crate::data::Samples;
use crate::dictionary::BadValue;
use crate::lang::model::{Model, RightSide};
use crate::library::{Library, known_terms};
use crate::solve::Solver;
use crate::term::Term;

pub use discovery::{
    Discovery, Equation, Evidence, Failed, FoundTerm, HeldOut, Proof, Reason, Status, Variable,
};
pub use form::{Form, NotRunnable, Rate, Row, Weighted};
pub use watch::{Stage, Step, Stop, Watch};

/// How to look.
#[derive(Clone, Copy)]
pub struct Options {
    pub solver: &'static dyn Solver,
    /// Rows to draw at random; the rest is held out.
    pub samples: Option<usize>,
    /// Seed of that draw.
    pub seed: u64,
    /// Most bytes that one equation's Φ may take.
    pub memory: u64,
}

/// A term that the data cannot evaluate: which equation asked for it, and where it fails.
pub type Unevaluable = (usize, Box<BadValue>);

/// Finds every equation of the model. `libraries` has one entry an equation, `None` for those that are known. Where `watch`
/// ends the work, the equations found so far stand, and the others are listed as failed.
///
/// # Errors
/// Terms without a finite value on the data, one an equation.
pub fn discover(
    model: &Model,
    libraries: &[Option<Library>],
    samples: &Samples,
    options: &Options,
    watch: Watch,
) -> Result<Discovery, Vec<Unevaluable>> {
    let mut discovery = Discovery::of(model);
    let mut bad = Vec::new();
    let mut watcher = watch::Watcher::new(watch);
    for (i, (equation, library)) in model.equations.iter().zip(libraries).enumerate() {
        let known = fixed_terms(&equation.right);
        let Some(library) = library else {
            discovery.equations.push(stated(equation.target, known));
            continue;
        };
        let task = equation::Task {
            target: equation.target,
            known,
            library,
            samples,
            options,
        };
        watcher.turn_to(i);
        match task.run(&discovery, &mut watcher) {
            Ok(Ok(found)) => discovery.equations.push(found),
            Ok(Err(failed)) => discovery.failed.push(failed),
            Err(value) => bad.push((i, value)),
        }
    }
    if !bad.is_empty() {
        return Err(bad);
    }
    mass::judge_together(&mut discovery, samples);
    constraints::judge(&mut discovery, model);
    Ok(discovery)
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
    }
}

fn fixed((coefficient, term): (f64, Term)) -> FoundTerm {
    FoundTerm {
        term,
        coefficient,
        fixed: true,
        standard_error: None,
    }
}
