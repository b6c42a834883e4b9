//! Coefficients and unknown constants that differ between runs, as parameters of the runs.
//!
//! In: a discovery, with the model and the records that it is asked about. Out: the same equations with a parameter of the run in place of
//! each such coefficient, so that simulations and predictions take every run with its own value. A run that is not known takes
//! the mean. Estimates nothing.

use sidc_data::Dataset;
use sidc_lang::model::{Model, Var, VarKind};
use sidc_lang::term::{Signal, Term, VarId};

use super::equations::{Discovery, FoundTerm, Variable};
use super::run_coefficients::RunCoefficient;

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
        let coefficients = found.equations.iter().any(|e| e.terms.iter().any(by_run));
        if !coefficients && found.unknowns.iter().all(|u| u.run.is_none()) {
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
                noise_time_constant: None,
                hidden: false,
                unit: None,
                between: None,
                delay: None,
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
        parameters.extend(constants(found));
        // What has no value is a parameter of the equations.
        discovery.unknowns.retain(|u| u.run.is_none());
        Some(out)
    }

    /// The records with a column of each parameter.
    pub fn with_values(&self, data: &Dataset) -> Dataset {
        let mut data = data.clone();
        let mut seen: Vec<String> = Vec::new();
        for trajectory in &mut data.trajectories {
            // Files of one name in several folders are told apart by their order.
            let place = seen.iter().filter(|n| **n == trajectory.name).count();
            seen.push(trajectory.name.clone());
            for p in &self.parameters {
                let named = || p.runs.iter().filter(|r| r.run == trajectory.name);
                let known = named().nth(place).or_else(|| named().next());
                let value = known.map_or(p.mean, |r| r.coefficient);
                trajectory.columns.retain(|(s, _)| *s != p.signal);
                trajectory
                    .columns
                    .push((p.signal, vec![value; trajectory.time.len()]));
            }
            trajectory.columns.sort_by_key(|(s, _)| *s);
        }
        data
    }
}

/// The unknown constants that have a value in each run.
fn constants(found: &Discovery) -> Vec<Parameter> {
    let mut out: Vec<Parameter> = Vec::new();
    for value in found.constant_values() {
        let Some(run) = value.run else { continue };
        let mean = found.unknown_value(value.signal).unwrap_or(value.value);
        let coefficient = RunCoefficient {
            run,
            coefficient: value.value,
            standard_error: None,
        };
        match out.iter_mut().find(|p| p.signal == value.signal) {
            Some(own) => own.runs.push(coefficient),
            None => out.push(Parameter {
                signal: value.signal,
                mean,
                runs: vec![coefficient],
            }),
        }
    }
    out
}

/// `coef1`, or the next like it that is free.
fn new_name(variables: &[Variable], from: usize) -> String {
    let taken = |name: &String| variables.iter().any(|v| v.name == *name);
    let mut names = (from..).map(|k| format!("coef{k}"));
    names.find(|n| !taken(n)).unwrap_or_default()
}

impl FoundTerm {
    /// Makes the coefficient the mean of those of the runs, weighted by the inverse of their variances.
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
