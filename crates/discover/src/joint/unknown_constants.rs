//! Unknown constants inside terms, estimated together with the trajectory.
//!
//! In: a model, its libraries, a dataset, the problem. Out: the problem with the constants' values, and what is known of them. A search on rows
//! of estimated derivatives starts them; then terms are searched at these values, and the likelihood of the constants is maximised for the terms,
//! in turn.

use std::borrow::Cow;

use crate::joint::constrained_search::{Settled, search_under_constraints};
use crate::joint::weak_start::weak_start;
use crate::needed_signals::needed_signals;
use crate::options::Options;
use crate::trajectory::{
    CONSTANTS, FittedConstants, Found, Parameter, Problem, SoughtConstant, fit_constants,
    fit_constants_from, fit_proposed, likely_constants, untold_parameters, with_constant_values,
    with_started_states, without_weak_terms,
};
use crate::unknown_constants::{self, Sought};
use sidc_data::{ConstantValue, Dataset, Samples, samples};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, SignalNames};
use sidc_progress::EquationObserver;
use sidc_system::discovery::{Discovery, UnknownValue};

/// The unknown constants of a model, in order of declaration.
pub(crate) struct Constants {
    sought: Vec<SoughtConstant>,
}

/// Settles the unknown constants of a model.
pub(crate) fn settle(
    (model, libraries): (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    options: &Options,
    watcher: &mut EquationObserver,
) -> Constants {
    if model.unknowns.is_empty() {
        return Constants { sought: Vec::new() };
    }
    let of = (model, libraries);
    let (all, minima) = match problem.system.hidden.is_empty() {
        true => minima_on_rows(of, (dataset, problem), options, watcher),
        false => minima_with_hidden_states(model, problem, watcher),
    };
    let all = &all[..];
    let mut constants = Constants { sought: Vec::new() };
    let mut best: Option<(f64, Option<FittedConstants>)> = None;
    let mut seen: Vec<Vec<f64>> = Vec::new();
    for minimum in &minima {
        let mut start = Constants::new(all, minimum);
        start.refine_with_hidden_states(problem, watcher);
        // Minima that the refinement leads to one place are one.
        let values: Vec<f64> = start.sought.iter().map(|c| c.value).collect();
        if seen.iter().any(|v| unknown_constants::alike(v, &values)) {
            continue;
        }
        seen.push(values);
        let searched = start.searched(of, (dataset, problem), options, watcher);
        let better = match (&searched, &best) {
            (Some(new), Some(old)) => new.0 < old.0,
            (found, _) => found.is_some() || constants.sought.is_empty(),
        };
        if better {
            (constants, best) = (start, searched);
        }
    }
    for round in 0..CONSTANTS.rounds {
        if round > 0 {
            best = constants.searched(of, (dataset, problem), options, watcher);
        }
        let Some((_, Some(fitted))) = best.take() else {
            break;
        };
        let near = |(a, (b, e)): (&SoughtConstant, (&SoughtConstant, &f64))| {
            (a.value - b.value).abs() <= 0.1 * e
        };
        let after = fitted.constants.iter().zip(&fitted.standard_errors);
        let settled = constants.sought.iter().zip(after).all(near);
        constants.sought = fitted.constants;
        if settled {
            break;
        }
    }
    constants
}

/// Where the constants may be by a search on rows of estimated derivatives.
fn minima_on_rows(
    of: (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    options: &Options,
    watcher: &mut EquationObserver,
) -> (Vec<Sought>, Vec<Vec<f64>>) {
    let (rows, _, _) = samples(of.0, dataset, &needed_signals(of.0, of.1), watcher);
    let minima = unknown_constants::settle(of, (&rows, CONSTANTS.ranked), options, watcher);
    let all = unknown_constants::sought(of.0, &rows);
    let minima = likeliest(of, (dataset, problem), (&all, minima), options, watcher);
    (all, minima)
}

/// The same by what the measured laws make of the hidden states. Constants that differ from run to run start alike.
fn minima_with_hidden_states(
    model: &Model,
    problem: &Problem,
    watcher: &mut EquationObserver,
) -> (Vec<Sought>, Vec<Vec<f64>>) {
    let runs = Samples {
        trajectory: problem.runs().into_iter().map(|r| r as u32).collect(),
        ..Samples::default()
    };
    let all = unknown_constants::sought(model, &runs);
    let ranges = model.unknowns.iter();
    let ranges = ranges.map(|u| (Signal::new(u.var), u.ranges())).collect();
    let minima = likely_constants(problem, &ranges, watcher).into_iter();
    let each = |values: Vec<f64>| all.iter().map(|s| values[s.place]).collect();
    let minima = minima.map(each).collect();
    (all, minima)
}

/// Of many points those that are likeliest with the terms that the weak form finds there. Where it finds none, all as they come.
fn likeliest(
    (model, libraries): (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    (all, points): (&[Sought], Vec<Vec<f64>>),
    options: &Options,
    watcher: &mut EquationObserver,
) -> Vec<Vec<f64>> {
    let mut ranked: Vec<(f64, Vec<f64>)> = Vec::new();
    for values in points {
        let constants = Constants::new(all, &values);
        let (at, acting) = (constants.problem(problem), constants.dataset(dataset));
        let start = weak_start((model, libraries), &acting, &at, options, watcher);
        let fitted =
            start.and_then(|s| fit_constants_from(&at, &s, &constants.sought, 1.0, watcher));
        let new = |f: &FittedConstants| (f.value, f.constants.iter().map(|c| c.value).collect());
        let entry = fitted.as_ref().map_or((f64::INFINITY, values), new);
        let near = |(_, v): &(f64, Vec<f64>)| unknown_constants::alike(v, &entry.1);
        if !ranked.iter().any(near) {
            ranked.push(entry);
        }
        if watcher.stop().is_some() {
            break;
        }
    }
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let likeliest = ranked.into_iter().take(CONSTANTS.starts);
    likeliest.map(|(_, values)| values).collect()
}

impl Constants {
    /// A search of terms at these values: its criterion, and the values of the largest likelihood for its terms. `None` where nothing fits,
    /// or the work was ended.
    fn searched(
        &self,
        (model, libraries): (&Model, &[Option<Library>]),
        (dataset, problem): (&Dataset, &Problem),
        options: &Options,
        watcher: &mut EquationObserver,
    ) -> Option<(f64, Option<FittedConstants>)> {
        let (at, acting) = (self.started(problem, watcher), self.dataset(dataset));
        let start = weak_start((model, libraries), &acting, &at, options, watcher);
        let settled = search_under_constraints((model, &at), start, options, watcher);
        let Settled::Answer(answer) = settled else {
            return None;
        };
        let (of, found) = (&answer.fit.problem, &answer.fit.found);
        let fitted = fit_constants(of, &found.best, &self.sought, found.inefficiency, watcher);
        let fitted = fitted.map(|f| without_weak_terms(of, f, found.inefficiency, watcher));
        let value = fitted.as_ref().map_or(found.best.value, |f| f.value);
        watcher.stop().is_none().then_some((value, fitted))
    }
}

impl Constants {
    fn new(all: &[Sought], values: &[f64]) -> Constants {
        let one = |(s, value): (&Sought, &f64)| SoughtConstant {
            signal: s.signal(),
            run: s.run.map(|run| run as usize),
            value: *value,
            range: s.unknown.range_about(*value),
        };
        Constants {
            sought: all.iter().zip(values).map(one).collect(),
        }
    }

    /// Beside hidden states, the likeliest values for the columns that these propose: a delay would be found for what a wrong constant leaves.
    /// Constants that the readings do not tell stay where they are, of each direction in which nothing is read the one that moves most: a fit
    /// of all of them would run along it.
    fn refine_with_hidden_states(&mut self, problem: &Problem, watcher: &mut EquationObserver) {
        if problem.system.hidden.is_empty() {
            return;
        }
        let at = self.started(problem, watcher);
        let Some(fit) = fit_proposed(&at, watcher) else {
            return;
        };
        for direction in untold_parameters(&at, &fit, &self.sought, 1.0, watcher) {
            let constant = direction.iter().filter_map(|(p, by)| match p {
                Parameter::Constant(k) => Some((*k, by.abs())),
                Parameter::Coefficient(_) => None,
            });
            if let Some((k, _)) = constant.max_by(|a, b| a.1.total_cmp(&b.1)) {
                let value = self.sought[k].value;
                self.sought[k].range = (value, value);
            }
        }
        if let Some(likelier) = fit_constants(&at, &fit, &self.sought, 1.0, watcher) {
            self.sought = likelier.constants;
        }
    }

    /// The constants with their values.
    pub fn sought(&self) -> &[SoughtConstant] {
        &self.sought
    }

    fn values(&self, names: &dyn Fn(usize) -> Option<String>) -> Vec<ConstantValue> {
        let one = |c: &SoughtConstant| ConstantValue {
            signal: c.signal,
            run: c.run.and_then(names),
            value: c.value,
        };
        self.sought.iter().map(one).collect()
    }

    /// The problem with the values.
    pub fn problem<'a>(&self, problem: &'a Problem) -> Cow<'a, Problem> {
        match self.sought.is_empty() {
            true => Cow::Borrowed(problem),
            false => Cow::Owned(with_constant_values(problem, &self.sought)),
        }
    }

    /// The same, with a start for its hidden states.
    pub fn started<'a>(
        &self,
        problem: &'a Problem,
        watcher: &mut EquationObserver,
    ) -> Cow<'a, Problem> {
        let at = self.problem(problem);
        match at.system.hidden.is_empty() {
            true => at,
            false => Cow::Owned(with_started_states(&at, watcher)),
        }
    }

    /// The records with the values.
    pub fn dataset<'a>(&self, dataset: &'a Dataset) -> Cow<'a, Dataset> {
        match self.sought.is_empty() {
            true => Cow::Borrowed(dataset),
            false => {
                let name = |run: usize| dataset.trajectories.get(run).map(|t| t.name.clone());
                Cow::Owned(dataset.with_constants(&self.values(&name)))
            }
        }
    }

    /// States the constants that stand in the equations; the coefficients' errors then hold theirs.
    pub fn state(
        &self,
        model: &Model,
        (problem, found): (&Problem, &Found),
        discovery: &mut Discovery,
        watcher: &mut EquationObserver,
    ) {
        if self.sought.is_empty() {
            return;
        }
        let fitted = fit_constants(
            problem,
            &found.best,
            &self.sought,
            found.inefficiency,
            watcher,
        );
        if let Some(fitted) = &fitted {
            for (column, variance) in found.best.support().iter().zip(&fitted.variances) {
                let law = &problem.system.laws[problem.system.law_of(*column)];
                let term = problem.term(*column);
                let own = discovery
                    .equations
                    .iter_mut()
                    .filter(|e| e.target == law.target);
                for t in own.flat_map(|e| &mut e.terms).filter(|t| t.term == *term) {
                    let wider = |e: f64| e.max(variance.sqrt());
                    t.standard_error = t.standard_error.map(wider);
                }
            }
        }
        let used = |s: Signal| {
            let mut terms = discovery.equations.iter().flat_map(|e| &e.terms);
            terms.any(|t| t.term.mentions(s))
        };
        let told = self
            .sought
            .iter()
            .enumerate()
            .filter(|(_, c)| used(c.signal));
        let told = told.map(|(k, c)| {
            let error = fitted
                .as_ref()
                .and_then(|f| f.standard_errors.get(k))
                .copied();
            let error = error.filter(|e| e.is_finite());
            let run = c.run.and_then(|run| problem.names.get(run).cloned());
            UnknownValue::new(model.name(c.signal), c.value, error).of_run(run)
        });
        discovery.unknowns = told.collect();
    }
}
