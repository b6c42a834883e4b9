//! Unknown constants inside terms, estimated together with the trajectory.
//!
//! In: a model, its libraries, a dataset, the problem. Out: the problem with the constants' values, and what is known of them. A search on rows
//! of estimated derivatives starts them; then terms are searched at these values, and the likelihood of the constants is maximised for the terms,
//! in turn.

use std::borrow::Cow;

use crate::doubts::constant_rules;
use crate::joint::named_correlations::named_correlations;
use crate::joint::weak_start::{value_of_weak_guess, weak_guesses};
use crate::needed_signals::needed_signals;
use crate::options::Options;
use crate::regression::thresholds::WEAK_FORM;
use crate::regression::uncoupled::{at_once, map_equations};
use crate::trajectory::{
    Answer, CONSTANTS, FittedConstants, Found, HIDDEN, Parameter, Problem, Rival, SoughtConstant,
    constants_by_runs, fit_constants, fit_constants_by_levels, fit_constants_from, fit_proposed,
    laws_with_constants, likely_constants, unidentifiable_directions, with_constant_values,
    with_started_states,
};
use crate::unknown_constants::{self, MinimaSought, Sought};
use sidc_data::{ConstantValue, Dataset, Samples, samples};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Language, Signal, SignalNames};
use sidc_progress::{EquationObserver, Observer};
use sidc_system::discovery::{Discovery, UnknownValue};

/// The unknown constants of a model, in order of declaration.
pub(crate) struct Constants {
    sought: Vec<SoughtConstant>,
    /// For each of `sought`: its constant in the model, and its run.
    all: Vec<Sought>,
    /// Values of the constants at which laws are looked for near an answer.
    points: Vec<Vec<f64>>,
}

/// Starts for the search of the unknown constants of a model, the likeliest first. At least one for a whole search; a sketch with hidden
/// states has none where every constant is likeliest at an end of its range: a lag as short as can be is no lag.
pub(crate) fn constant_starts(
    (model, libraries): (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    (options, sketched): (&Options, bool),
    watcher: &mut EquationObserver,
) -> Vec<Constants> {
    if model.unknowns.is_empty() {
        return vec![Constants::none()];
    }
    let of = (model, libraries);
    if !problem.system.hidden.is_empty() {
        let (all, mut minima) = minima_with_hidden_states(model, problem, watcher);
        if sketched {
            minima.retain(|values| !are_at_ends(&all, values));
        }
        let mut starts: Vec<Constants> = Vec::new();
        for values in &minima {
            let mut start = Constants::new(&all, values, &[]);
            start.refine_with_hidden_states(problem, watcher);
            // Starts that lead to the same values are tried once.
            if !starts.iter().any(|s| s.is_at(&start)) {
                starts.push(start);
            }
        }
        return starts;
    }
    let (rows, _, _) = samples(model, dataset, &needed_signals(model, libraries), watcher);
    let wanted = MinimaSought {
        most: CONSTANTS.ranked,
        below_errors: true,
    };
    let minima = unknown_constants::minima(of, (&rows, wanted), options, watcher);
    let all = unknown_constants::sought(model, &rows);
    let points = unknown_constants::points(of, &rows, options);
    let data = (dataset, problem);
    let mut starts = scanned(of, data, (&all, &points), options, watcher);
    starts.extend(minima);
    let minima = likeliest(of, data, (&all, starts), options, watcher);
    let starts = minima.iter();
    starts.map(|v| Constants::new(&all, v, &points)).collect()
}

/// Values of the constants at which the measured laws, with guessed hidden states, follow the readings best. Constants that differ between
/// runs start alike.
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
    let mut minima = likely_constants(problem, &ranges, watcher);
    if problem.system.columns.is_empty() {
        minima.extend(constants_by_runs(problem, &ranges, watcher));
    }
    let each = |values: Vec<f64>| all.iter().map(|s| values[s.place]).collect();
    let minima = minima.into_iter().map(each).collect();
    (all, minima)
}

/// Whether every constant is at an end of its range.
fn are_at_ends(all: &[Sought], values: &[f64]) -> bool {
    let mut all = all.iter().zip(values);
    all.all(|(s, value)| {
        let (from, to) = s.unknown.range_containing(*value);
        *value <= from || *value >= to
    })
}

/// The points at which the weak form explains most with few terms, no two alike. Only for large libraries: among few terms rows of derivatives
/// find the constants.
fn scanned(
    of: (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    (all, points): (&[Sought], &[Vec<f64>]),
    options: &Options,
    watcher: &mut EquationObserver,
) -> Vec<Vec<f64>> {
    if !is_large(problem) {
        return Vec::new();
    }
    let judged = |values: Vec<f64>, watcher: &mut EquationObserver| {
        if !watcher.go_on() {
            return (f64::INFINITY, values);
        }
        let constants = Constants::new(all, &values, &[]);
        let (at, acting) = (constants.problem(problem), constants.dataset(dataset));
        let value = value_of_weak_guess(of, &acting, &at, options, watcher);
        (value, values)
    };
    let ranked = at_each(points.to_vec(), problem, options, watcher, judged);
    best_distinct(ranked, CONSTANTS.scanned)
}

/// Whether the laws have so many candidates that values of the constants are scanned, and several of them searched.
fn is_large(problem: &Problem) -> bool {
    problem.system.columns.len() >= CONSTANTS.scanned_columns
}

/// The points of smallest value, no two alike; none whose value is infinite.
fn best_distinct(mut ranked: Vec<(f64, Vec<f64>)>, most: usize) -> Vec<Vec<f64>> {
    ranked.retain(|(value, _)| value.is_finite());
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Vec<Vec<f64>> = Vec::new();
    for (_, values) in ranked {
        let known = best.iter().any(|b| unknown_constants::alike(b, &values));
        if best.len() < most && !known {
            best.push(values);
        }
    }
    best
}

/// What `work` makes of each point, at as many at once as fit into memory.
fn at_each<A: Send>(
    points: Vec<Vec<f64>>,
    problem: &Problem,
    options: &Options,
    watcher: &mut EquationObserver,
    work: impl Fn(Vec<f64>, &mut EquationObserver) -> A + Sync,
) -> Vec<A> {
    let entries = (problem.system.columns.len() * problem.measurements()) as u128;
    let size = entries * u128::from(WEAK_FORM.bytes_per_entry);
    let at_once = at_once(vec![size; points.len()], options.memory);
    let points = points.into_iter().map(|values| (0, values)).collect();
    let done = map_equations(at_once, points, watcher, work).into_iter();
    done.map(|(_, done)| done).collect()
}

/// The likeliest of many points, with their constants refined: the weak form gives the terms at each point. One point, or a few for a large
/// library, where the fit of a guess may not be the winner of the search; the first if the weak form finds no terms anywhere.
fn likeliest(
    (model, libraries): (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    (all, points): (&[Sought], Vec<Vec<f64>>),
    options: &Options,
    watcher: &mut EquationObserver,
) -> Vec<Vec<f64>> {
    let fitted_from = |values: Vec<f64>, watcher: &mut EquationObserver| {
        if !watcher.go_on() {
            return (f64::INFINITY, values);
        }
        let constants = Constants::new(all, &values, &[]);
        let (at, acting) = (constants.problem(problem), constants.dataset(dataset));
        let fitted = match at.system.columns.is_empty() {
            true => fit_constants_by_levels(&at, &constants.sought, watcher),
            false => {
                let guesses = weak_guesses((model, libraries), &acting, &at, options, watcher);
                let fits = guesses.iter().filter_map(|guess| {
                    fit_constants_from(&at, guess, &constants.sought, 1.0, watcher)
                });
                fits.min_by(|a, b| a.value.total_cmp(&b.value))
            }
        };
        let new = |f: &FittedConstants| (f.value, f.constants.iter().map(|c| c.value).collect());
        fitted.as_ref().map_or((f64::INFINITY, values), new)
    };
    let first: Vec<Vec<f64>> = points.iter().take(1).cloned().collect();
    let ranked = at_each(points, problem, options, watcher, fitted_from);
    let most = match is_large(problem) {
        true => CONSTANTS.searched,
        false => 1,
    };
    let best = best_distinct(ranked, most);
    match best.is_empty() {
        true => first,
        false => best,
    }
}

impl Constants {
    pub fn none() -> Constants {
        Constants::new(&[], &[], &[])
    }

    pub fn is_at(&self, other: &Constants) -> bool {
        let values = |of: &Constants| of.sought.iter().map(|c| c.value).collect::<Vec<f64>>();
        unknown_constants::alike(&values(self), &values(other))
    }

    fn new(all: &[Sought], values: &[f64], points: &[Vec<f64>]) -> Constants {
        let one = |(s, value): (&Sought, &f64)| SoughtConstant {
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
    fn refine_with_hidden_states(&mut self, problem: &Problem, watcher: &mut EquationObserver) {
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
        match at.system.hidden.is_empty() {
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
