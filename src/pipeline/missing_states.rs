//! Tries one more, unmeasured state in the model if the answer is doubted; after regression also inputs that act late.
//!
//! In: a program, its data, the answer with its doubts. Out: one more doubt if a model with one more state describes the readings better. It names the state,
//! says what would be found with it, and gives the lines to paste. The answer itself is not changed.
//!
//! The states tried are a first-order lag of each input and, in small models without hidden states, a lag of the sensor of each doubted state and a state
//! that drives the doubted laws and has a library like theirs. Each is estimated by a short search, and the criterion compares them with the answer and with
//! each other.

use sidc_data::Dataset;
use sidc_discover as discover;
use sidc_discover::{Description, Method, SearchScope};
use sidc_lang::added_state::{AddedState, driven_by_state, input_through_lag, sensor_with_lag};
use sidc_lang::library::{Library, MEMORY};
use sidc_lang::model::{Var, VarKind};
use sidc_lang::number::significant;
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, SignalNames};
use sidc_progress::{Activity, Observer};
use sidc_solve::threads::{self, map_watched};
use sidc_system::discovery::{Change, Discovery, Equation, Reason, ReasonCode, Status};

use super::program::{Program, compile};
use super::thresholds::MISSING;
use crate::options::Options;

/// A model with one more state, and what is found with it.
struct Proposal {
    /// What is added, in words: `a first-order lag of u`.
    what: String,
    added: AddedState,
    found: Discovery,
    description: Description,
}

/// Doubts an answer if a model with one more state describes the readings better. `description` is that of the answer; if the answer was found by regression,
/// the trajectory is estimated first.
pub(super) fn propose(
    (program, dataset): (&Program, &Dataset),
    found: &mut Discovery,
    description: Option<Description>,
    options: &Options,
    observer: &mut dyn Observer,
) {
    let doubted = doubted(found);
    // A delay sought in too short a range looks like a lag, so the range must be corrected first.
    let cut_off = found.doubt_codes().contains(&ReasonCode::DelayRange);
    let possible = may_have_more_states(program) && work(program, dataset) <= MISSING.work;
    // A law with many terms is not one that lacks a single state, and each of its terms makes the trials longer.
    let dense = (found.equations.iter()).any(|e| e.terms.len() > MISSING.terms);
    if doubted.is_empty()
        || dense
        || cut_off
        || explained_by_delay(found)
        || found.was_stopped()
        || !possible
    {
        return;
    }
    // The trials have other equations, so the observer is asked only whether to go on.
    let mut quiet = |_: Activity| observer.hear(Activity::Working);
    let mut trial = Trial {
        dataset,
        options,
        scope: SearchScope::Disturbances,
        observer: &mut quiet,
    };
    let (sketch, own) = match description {
        Some(own) => (None, Some(own)),
        None => trial.describe(program).unzip(),
    };
    let delay = sketch.as_ref().and_then(delay_of_input);
    let late = delay.is_some() || is_late(found);
    let Some(own) = own.filter(|o| o.leaves_more_than_noise() || late) else {
        return;
    };
    let explained = sketch.as_ref().is_some_and(explained_by_delay);
    let state = match explained {
        true => None,
        false => trial.added_state((program, &doubted), &own, is_late(found)),
    };
    if !trial.observer.go_on() {
        return;
    }
    if let Some((reason, explains)) = state.or(delay.map(|reason| (reason, true))) {
        tell(found, &doubted, &reason, explains);
    }
}

/// What programs are tried on, and how.
struct Trial<'a> {
    dataset: &'a Dataset,
    options: &'a Options,
    /// Disturbances are searched for along with an added state if the answer has some: each can stand for the other.
    scope: SearchScope,
    observer: &'a mut dyn Observer,
}

impl Trial<'_> {
    /// The added state that describes the readings best, if better than the model's `own` answer, or as well as one with a delay; and whether it explains them.
    fn added_state(
        &mut self,
        (program, doubted): (&Program, &[Signal]),
        own: &Description,
        late: bool,
    ) -> Option<(Reason, bool)> {
        if !own.is_disturbed() {
            self.scope = SearchScope::Sensors;
        }
        let of = (program, self.dataset);
        let mut tried = self.each(lagged(of, doubted), program);
        let explains =
            |p: &Proposal| !p.description.unexplained && p.description.is_better_than(own);
        if !tried.iter().any(explains) {
            tried.extend(self.each(driving(of, doubted).into_iter().collect(), program));
        }
        // Of models that the readings cannot distinguish, the first is given.
        let better = |a: &Proposal, b: &Proposal| a.description.is_better_than(&b.description);
        let best = (tried.iter()).reduce(|best, one| if better(one, best) { one } else { best })?;
        let others = tried.iter().filter(|o| o.added != best.added);
        let alike: Vec<&Proposal> = others.filter(|o| !better(best, o)).collect();
        let explains = !best.description.unexplained;
        if best.description.is_better_than(own) {
            let gain = best.description.gain_over(own);
            return Some((best.reason(gain, &alike), explains));
        }
        let instead = explains && late && !own.is_better_than(&best.description);
        instead.then(|| (best.instead_of_delay(), false))
    }

    /// What is found with each added state, unless nothing drives it or its constant is at an end of its range.
    fn each(&mut self, states: Vec<(String, AddedState)>, given: &Program) -> Vec<Proposal> {
        let (dataset, options, scope) = (self.dataset, self.options, self.scope);
        let proposal = |(what, added): (String, AddedState), observer: &mut dyn Observer| {
            let program = compiled(&added.text, given)?;
            let trial = &mut Trial {
                dataset,
                options,
                scope,
                observer,
            };
            let (found, description) = trial.describe(&program)?;
            let told = is_driven(&found, &added.state) && !is_at_end(&found, &program);
            told.then_some(Proposal {
                what,
                added,
                found,
                description,
            })
        };
        let tried = map_watched(threads::available(), states, self.observer, proposal);
        tried.into_iter().flatten().collect()
    }

    /// Estimates the equations of a program jointly with their trajectory, and how well they describe the readings.
    fn describe(&mut self, program: &Program) -> Option<(Discovery, Description)> {
        let mut search = self.options.search;
        search.method = Method::Joint;
        let of = (&program.model, &program.libraries[..]);
        let targets: Vec<_> = program.model.equations.iter().map(|e| e.target).collect();
        let dataset = &self.dataset.without(&targets).with_unknowns_of(of.0);
        let problem = discover::joint(of.0, of.1, dataset, &search, self.observer).ok()?;
        let data = (dataset, &problem);
        discover::describe_jointly(of, data, self.scope, &search, self.observer)
    }
}

/// Whether another signal drives the added state. A state that only decays or grows on its own is a slow disturbance.
fn is_driven(found: &Discovery, state: &str) -> bool {
    let own = |s: Signal| found.variable(s.var) == state;
    let mut laws = found.equations.iter().filter(|e| own(e.target));
    laws.any(|e| {
        let mut driven = false;
        let mut others = |s: Signal| driven |= !own(s);
        e.terms
            .iter()
            .for_each(|t| t.term.for_each_signal(&mut others));
        driven
    })
}

/// Whether a constant is at an end of its range. A time constant ends there if its input is integrated or followed at once.
fn is_at_end(found: &Discovery, program: &Program) -> bool {
    let unknowns = program.model.unknowns.iter();
    let ends = unknowns.flat_map(|u| {
        u.ranges()
            .into_iter()
            .map(|r| (program.model.var(u.var), r))
    });
    let mut ends = ends.filter_map(|(var, range)| Some((&var?.name, range)));
    let near = |a: f64, b: f64| (a - b).abs() <= MISSING.end * b.abs();
    ends.any(|(name, (from, to))| {
        let mut own = found.unknowns.iter().filter(|u| u.name == *name);
        own.any(|u| near(u.value, from) || near(u.value, to))
    })
}

/// Whether an unexplained disturbance drives an equation.
fn is_disturbed(equation: &Equation) -> bool {
    let together = equation.evidence.as_ref().and_then(|v| v.joint.as_ref());
    together.is_some_and(|t| t.disturbance.is_some())
}

/// Whether a delay that was found explains enough: with it no misfit remains, and no disturbance drives the laws.
fn explained_by_delay(found: &Discovery) -> bool {
    let misfit = found.doubt_codes().contains(&ReasonCode::Misfit);
    is_late(found) && !misfit && !found.equations.iter().any(is_disturbed)
}

/// Whether the answer is for inputs that act later than recorded.
fn is_late(found: &Discovery) -> bool {
    found.doubt_codes().contains(&ReasonCode::InputDelay)
}

/// The delay of inputs under which equations were found that are not the answer, with these.
fn delay_of_input(sketch: &Discovery) -> Option<Reason> {
    let mut reasons = sketch.equations.iter().flat_map(|e| &e.reasons);
    let late = reasons.find(|r| r.code == ReasonCode::InputDelay)?;
    let text = format!("{}: {}", late.text, laws_in_short(sketch).join(", "));
    let change = late.remedy.as_ref()?.change.clone()?;
    let way = "if that can be, declare it";
    Some(Reason::new(ReasonCode::InputDelay, text).change(way, change))
}

/// The laws that were searched, or all if all were given.
fn laws_in_short(found: &Discovery) -> Vec<String> {
    let searched = |e: &&Equation| e.terms.iter().any(|t| !t.fixed);
    let all_given = !found.equations.iter().any(|e| searched(&e));
    let laws = found.equations.iter().filter(|e| all_given || searched(e));
    laws.map(|e| found.in_short(e, MISSING.figures)).collect()
}

/// The equations whose residuals exceed the sensor's noise, as those of a missing state would, or that a disturbance drives.
fn doubted(found: &Discovery) -> Vec<Signal> {
    use ReasonCode::{
        BeyondLibrary, ColouredResiduals, Disturbed, ExhaustedLibrary, InputDelay, Misfit, PoorFit,
    };
    let codes = [
        BeyondLibrary,
        ColouredResiduals,
        Disturbed,
        ExhaustedLibrary,
        InputDelay,
        Misfit,
        PoorFit,
    ];
    let has =
        |e: &Equation, codes: &[ReasonCode]| e.reasons.iter().any(|r| codes.contains(&r.code));
    // Where a law of lower order holds, a state less is needed.
    let lower = |e: &Equation| has(e, &[ReasonCode::Relation]);
    let doubted = |e: &Equation| (has(e, &codes) || is_disturbed(e)) && !lower(e);
    let equations = found.equations.iter();
    let searched = equations.filter(|e| e.status != Status::Known);
    searched.filter(|e| doubted(e)).map(|e| e.target).collect()
}

/// Whether states can be added: not in discrete time, nor with per-run coefficients or constraints, which the added laws would not respect.
fn may_have_more_states(program: &Program) -> bool {
    let model = &program.model;
    !model.discrete && model.per_run.is_empty() && model.constraints.is_empty()
}

/// The number of column values that one search evaluates.
fn work(program: &Program, dataset: &Dataset) -> usize {
    let samples = dataset.trajectories.iter().map(|t| t.time.len());
    samples.sum::<usize>() * columns(program)
}

fn columns(program: &Program) -> usize {
    program.libraries.iter().flatten().map(Library::len).sum()
}

/// Lags of inputs and, in small models, of the sensors of doubted states.
fn lagged(
    (program, dataset): (&Program, &Dataset),
    doubted: &[Signal],
) -> Vec<(String, AddedState)> {
    let (text, model) = (&program.text, &program.model);
    let Some(range) = lags(dataset) else {
        return Vec::new();
    };
    let input = |(id, var): (_, &Var)| {
        let added = input_through_lag(text, model, id, range)?;
        Some((format!("a first-order lag of {}", var.name), added))
    };
    let sensor = |target: &Signal| {
        let mut rates = (1..=target.der).map(|der| Signal::derivative(target.var, der));
        let var = model.var(target.var)?;
        let added = sensor_with_lag(text, model, target.var, range)?;
        let what = format!("a first-order lag of the sensor of {}", var.name);
        (!rates.any(|s| dataset.has(s))).then_some((what, added))
    };
    let inputs = model.vars_of(VarKind::Input).take(MISSING.inputs);
    let sensors = doubted
        .iter()
        .take(MISSING.sensors)
        .filter(|_| is_small(program, dataset));
    inputs
        .filter_map(input)
        .chain(sensors.filter_map(sensor))
        .collect()
}

/// A state that drives the doubted laws; only in small models.
fn driving(
    (program, dataset): (&Program, &Dataset),
    doubted: &[Signal],
) -> Option<(String, AddedState)> {
    let one_text = match program.includes_files {
        true => Some(compiled(&program.text, program)?),
        false => None,
    };
    let program = one_text.as_ref().unwrap_or(program);
    let equations = program.model.equations.iter().enumerate();
    let driven = equations.filter(|(_, e)| doubted.contains(&e.target));
    let driven: Vec<usize> = driven.map(|(i, _)| i).collect();
    let added = driven_by_state(&program.text, &program.model, &driven)?;
    let what = format!("a state {} that nothing measures", added.state);
    is_small(program, dataset).then_some((what, added))
}

/// Whether laws with an unmeasured state can be searched: little work, no other such state, and rates that need not be solved for at every step.
fn is_small(program: &Program, dataset: &Dataset) -> bool {
    let hidden = program.model.hidden_states().next().is_some();
    let targets: Vec<Signal> = program.model.equations.iter().map(|e| e.target).collect();
    let mut libraries = program.libraries.iter().flatten();
    let implicit = libraries.any(|l| l.signals().iter().any(|s| targets.contains(s)));
    !hidden && !implicit && work(program, dataset) <= MISSING.work_along_course
}

/// The range of time constants that the records can show, from the shortest step to the length of the longest record.
fn lags(dataset: &Dataset) -> Option<(f64, f64)> {
    let times = dataset.trajectories.iter().map(|t| &t.time);
    let steps = times
        .clone()
        .flat_map(|t| t.windows(2).map(|w| w[1] - w[0]));
    let step = steps.filter(|s| *s > 0.0).reduce(f64::min)?;
    let lengths = times.filter_map(|t| Some(t.last()? - t.first()?));
    let length = lengths.reduce(f64::max)?;
    let from = MISSING.shortest_lag * step;
    (from < length).then_some((from, length))
}

/// Compiles a longer text, with the noise that was given for the sensors of the model.
fn compiled(text: &str, given: &Program) -> Option<Program> {
    let mut sources = Sources::default();
    let file = sources.add("", text);
    let mut program = compile(file, &sources, MEMORY).0?;
    for (var, known) in program.model.vars.iter_mut().zip(&given.model.vars) {
        var.noise = known.noise.clone();
    }
    Some(program)
}

impl Proposal {
    fn reason(&self, gain: f64, alike: &[&Proposal]) -> Reason {
        let left = match self.description.unexplained {
            true => "",
            false => ", and nothing but noise is left",
        };
        let or = alike.iter().map(|o| format!(" or {}", o.what));
        let or: String = or.collect();
        let which = if alike.is_empty() {
            ""
        } else {
            " (they do not tell which)"
        };
        let text = format!(
            "with {}{or} the readings are described better{which}, the criterion says by {gain:.0}{left}: {}",
            self.what,
            self.equations().join(", ")
        );
        self.with_lines(text)
    }

    fn instead_of_delay(&self) -> Reason {
        let text = format!(
            "the readings do not tell a delay from {}: {}",
            self.what,
            self.equations().join(", ")
        );
        self.with_lines(text)
    }

    fn with_lines(&self, text: String) -> Reason {
        let lines = Change::Model(self.added.lines.clone());
        let way = "name that state, if there is something that moves so";
        Reason::new(ReasonCode::MissingState, text).change(way, lines)
    }

    /// What is found: the laws and the time constant.
    fn equations(&self) -> Vec<String> {
        let constants = self.found.unknowns.iter().map(|u| {
            let value = significant(u.value, MISSING.figures);
            format!("{} = {value}", u.name)
        });
        let laws = laws_in_short(&self.found);
        laws.into_iter().chain(constants).collect()
    }
}

/// Adds the reason to the doubted equations: first if the added state explains the readings, last if more is missing.
fn tell(found: &mut Discovery, doubted: &[Signal], reason: &Reason, explains: bool) {
    let equations = found.equations.iter_mut();
    for equation in equations.filter(|e| doubted.contains(&e.target)) {
        equation.doubt(reason.clone());
        if explains {
            equation.reasons.rotate_right(1);
        }
    }
}
