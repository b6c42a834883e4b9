//! Coefficients that have a value of their own in each run.
//!
//! In: a discovery, with the model and the records that it is asked about. Out: the same equations with a parameter of the run in place of
//! each such coefficient, so that simulations and predictions take every run with its own value. A run that is not known takes
//! the mean. Estimates nothing.

use serde::{Deserialize, Serialize};
use sidc_data::Dataset;
use sidc_lang::model::{Model, Var, VarKind};
use sidc_lang::number::with_error;
use sidc_lang::term::{Signal, Term, VarId};

use crate::discovery::{Discovery, FoundTerm, Variable};

/// A coefficient in one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunCoefficient {
    /// The run's name: that of its file, and its id if one file holds several.
    pub run: String,
    pub coefficient: f64,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub standard_error: Option<f64>,
}

impl RunCoefficient {
    /// The value with its standard error in the last digits: `-0.50(2)`.
    pub fn figure(&self) -> String {
        const DIGITS: usize = 6;
        let sign = if self.coefficient < 0.0 { "-" } else { "" };
        let error = self.standard_error.unwrap_or(0.0);
        let size = with_error(self.coefficient.abs(), error, DIGITS);
        format!("{sign}{size}")
    }
}

/// Equations whose coefficients by run are parameters.
#[derive(Clone, Debug)]
pub struct RunParameters {
    pub discovery: Discovery,
    pub model: Model,
    parameters: Vec<Parameter>,
}

#[derive(Clone, Debug)]
struct Parameter {
    signal: Signal,
    /// Of a run that is not known.
    mean: f64,
    runs: Vec<RunCoefficient>,
}

impl RunParameters {
    /// `None` where no coefficient differs between runs.
    pub fn of(found: &Discovery, model: &Model) -> Option<RunParameters> {
        let by_run = |t: &FoundTerm| !t.runs.is_empty();
        if !found.equations.iter().any(|e| e.terms.iter().any(by_run)) {
            return None;
        }
        let mut out = RunParameters {
            discovery: found.clone(),
            model: model.clone(),
            parameters: Vec::new(),
        };
        let RunParameters {
            discovery,
            model,
            parameters,
        } = &mut out;
        let terms = discovery.equations.iter_mut().flat_map(|e| &mut e.terms);
        for term in terms.filter(|t| by_run(t)) {
            let id = VarId(discovery.variables.len() as u16);
            let name = new_name(&discovery.variables, parameters.len() + 1);
            discovery.variables.push(Variable {
                name: name.clone(),
                kind: VarKind::Param,
                order: 0,
                unit: None,
            });
            model.vars.push(Var {
                name,
                kind: VarKind::Param,
                order: 0,
                noise: Default::default(),
                unit: None,
                between: None,
                span: None,
            });
            let signal = Signal::new(id);
            parameters.push(Parameter {
                signal,
                mean: term.coefficient,
                runs: std::mem::take(&mut term.runs),
            });
            term.term = term.term.mul(&Term::signal(signal));
            term.coefficient = 1.0;
        }
        Some(out)
    }

    /// The records with a column of each parameter.
    pub fn with_values(&self, data: &Dataset) -> Dataset {
        let mut data = data.clone();
        for trajectory in &mut data.trajectories {
            for p in &self.parameters {
                let known = p.runs.iter().find(|r| r.run == trajectory.name);
                let value = known.map_or(p.mean, |r| r.coefficient);
                trajectory
                    .columns
                    .push((p.signal, vec![value; trajectory.time.len()]));
            }
            trajectory.columns.sort_by_key(|(s, _)| *s);
        }
        data
    }
}

/// `coef1`, or the next like it that is free.
fn new_name(variables: &[Variable], from: usize) -> String {
    let taken = |name: &String| variables.iter().any(|v| v.name == *name);
    let mut names = (from..).map(|k| format!("coef{k}"));
    names.find(|n| !taken(n)).unwrap_or_default()
}

impl FoundTerm {
    /// Makes the coefficient the mean of those of the runs, each weighing as much as it is known.
    pub fn take_mean(&mut self) {
        let known = |r: &&RunCoefficient| r.standard_error.is_some_and(|e| e > 0.0);
        let weight = |r: &RunCoefficient| r.standard_error.map_or(0.0, |e| e.powi(-2));
        let runs = || self.runs.iter().filter(known);
        let weights: f64 = runs().map(weight).sum();
        if weights > 0.0 && weights.is_finite() {
            let sum: f64 = runs().map(|r| weight(r) * r.coefficient).sum();
            self.standard_error = Some(weights.powf(-0.5));
            self.coefficient = sum / weights;
        }
    }
}

impl Discovery {
    /// The records without the runs that the equations do not follow.
    pub fn followed(&self, data: &Dataset) -> Dataset {
        let mut data = data.clone();
        data.trajectories
            .retain(|t| !self.runs_left.contains(&t.name));
        data
    }
}
