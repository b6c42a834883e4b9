//! Unknown constants inside terms, estimated together with the trajectory.
//!
//! In: a model, its libraries, a dataset, the problem. Out: the problem with the constants' values, and what is known of them. Terms are searched
//! at values to start from (`constant_starts`), and the likelihood of the constants is maximised for the terms, in turn.

use std::borrow::Cow;

use crate::doubts::constant_rules;
use crate::joint::named_correlations::named_correlations;
use crate::trajectory::{
    Answer, FittedConstants, Found, HIDDEN, Parameter, Problem, Rival, SoughtConstant,
    fit_constants, fit_constants_by_levels, fit_proposed, laws_with_constants,
    unidentifiable_directions, with_constant_values, with_flown_states, with_started_states,
};
use crate::unknown_constants::{self, SearchedConstant};
use sidc_data::{ConstantValue, Dataset};
use sidc_lang::model::{Model, Reset};
use sidc_lang::term::{Language, Signal, SignalNames};
use sidc_progress::EquationObserver;
use sidc_system::discovery::{Discovery, UnknownValue};

/// The unknown constants of a model, in order of declaration.
pub(crate) struct Constants {
    sought: Vec<SoughtConstant>,
    /// For each of `sought`: its constant in the model, and its run.
    all: Vec<SearchedConstant>,
    /// Values of the constants at which laws are looked for near an answer.
    points: Vec<Vec<f64>>,
}

impl Constants {
    pub fn none() -> Constants {
        Constants::new(&[], &[], &[])
    }

    pub fn is_at(&self, other: &Constants) -> bool {
        let values = |of: &Constants| of.sought.iter().map(|c| c.value).collect::<Vec<f64>>();
        unknown_constants::alike(&values(self), &values(other))
    }

    pub fn new(all: &[SearchedConstant], values: &[f64], points: &[Vec<f64>]) -> Constants {
        let one = |(s, value): (&SearchedConstant, &f64)| SoughtConstant {
            signal: s.signal(),
            run: s.run.map(|run| run as usize),
            value: *value,
            range: s.unknown.range_containing(*value),
        };
        Constants {
            sought: all.iter().zip(values).map(one).collect(),
            all: all.to_vec(),
            points: points.to_vec(),
        }
    }

    /// The same at these values.
    pub fn moved_to(&self, constants: Vec<SoughtConstant>) -> Constants {
        Constants {
            sought: constants,
            all: self.all.clone(),
            points: self.points.clone(),
        }
    }

    /// Laws near an answer, each with its likeliest constants. If the answer does not explain the readings, only laws that may be better
    /// than it.
    pub fn laws_about(
        &self,
        (problem, found): (&Problem, &Found),
        explained: bool,
        watcher: &mut EquationObserver,
    ) -> Vec<FittedConstants> {
        if self.sought.is_empty() {
            return Vec::new();
        }
        let range = |k: usize, value: f64| self.all[k].unknown.range_containing(value);
        let about = Answer {
            problem,
            found,
            explained,
        };
        laws_with_constants(&about, &self.sought, &self.points, &range, watcher)
    }

    /// The likeliest constants for the terms of an answer; `None` where its laws hold none.
    pub fn likeliest_in(
        &self,
        (problem, found): (&Problem, &Found),
        watcher: &mut EquationObserver,
    ) -> Option<Constants> {
        let (best, inefficiency) = (&found.best, found.inefficiency);
        let fitted = fit_constants(problem, best, &self.sought, inefficiency, watcher)?;
        Some(self.moved_to(fitted.constants))
    }

    /// Beside hidden states, moves the constants to the likeliest values for the columns proposed there, so that the error of a constant is
    /// not taken for a delay. Of parameters that the readings cannot determine together, the constant that moves most is held: a fit of all
    /// of them would drift along that direction.
    pub fn refine_with_hidden_states(&mut self, problem: &Problem, watcher: &mut EquationObserver) {
        if problem.system.hidden.is_empty() {
            return;
        }
        let at = self.started(problem, HIDDEN.courses, watcher);
        if problem.system.columns.is_empty() {
            if let Some(likelier) = fit_constants_by_levels(&at, &self.sought, watcher) {
                self.sought = likelier.constants;
            }
            return;
        }
        let Some(fit) = fit_proposed(&at, watcher) else {
            return;
        };
        for direction in unidentifiable_directions(&at, &fit, &self.sought, 1.0, watcher) {
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

    /// The same, with initial courses for its hidden states: the best of at most `most`.
    pub fn started<'a>(
        &self,
        problem: &'a Problem,
        most: usize,
        watcher: &mut EquationObserver,
    ) -> Cow<'a, Problem> {
        let at = self.problem(problem);
        let flies = !at.system.resets.is_empty();
        match at.system.hidden.is_empty() {
            true if flies => Cow::Owned(with_flown_states(&at, watcher)),
            true => at,
            false => Cow::Owned(with_started_states(&at, most, watcher)),
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

    /// Reports the constants in the equations. The standard errors of coefficients then include the error of the constants.
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
            let mut resets = discovery.resets.iter().flat_map(Reset::expressions);
            terms.any(|t| t.term.mentions(s)) || resets.any(|e| e.mentions(s))
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
        let fit = (problem, found);
        discovery.correlations = named_correlations(fit, &self.sought, discovery, watcher)
            .into_iter()
            .collect();
        if discovery.unknowns.is_empty() {
            self.doubt_absent(model, (problem, found), discovery);
        }
    }

    /// Doubts the equations whose libraries hold constants, where none stands in an equation.
    fn doubt_absent(
        &self,
        model: &Model,
        (problem, found): (&Problem, &Found),
        discovery: &mut Discovery,
    ) {
        let system = &problem.system;
        let holds = |j: &usize| {
            let term = &system.columns[*j];
            self.sought.iter().any(|c| term.mentions(c.signal))
        };
        let mut rivals = found.rivals.iter();
        let nearest = rivals.find(|r| r.support.iter().any(holds));
        for law in system
            .laws
            .iter()
            .filter(|l| l.columns.clone().any(|j| holds(&j)))
        {
            let terms = nearest.map(|Rival { support, value, .. }| {
                let own = support.iter().filter(|j| law.columns.contains(j));
                let language = Language(&*discovery);
                let names = own.map(|j| language.term(problem.term(*j))).collect();
                (names, value - found.best.value)
            });
            let reason = constant_rules::absent(model, terms);
            let mut all = discovery.equations.iter_mut();
            if let Some(equation) = all.find(|e| e.target == law.target) {
                equation.doubt(reason);
            }
        }
    }
}
