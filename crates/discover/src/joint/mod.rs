//! Joint estimation of all equations with their trajectory: when it applies, and its result as a discovery.
//!
//! In: a model, its libraries, a dataset. Out: the estimation problem, or why there is none; then equations with their evidence. The
//! constraints of the model hold in all of it.
//! Never estimates anything itself; `crate::trajectory` does.

mod applicability;
mod constant_starts;
mod constrained_search;
mod constraint_doubts;
mod cubic_inputs;
mod declared_delays;
mod declared_runs;
mod delay_outlier_search;
mod description;
mod disturbances;
mod hidden_states;
mod joint_fit;
mod library_probe;
mod named_correlations;
pub(crate) mod no_fit;
mod pooled_search;
mod report;
mod search_with_constants;
mod stated_constraints;
mod structural;
pub(crate) mod thresholds;
mod undeclared_delays;
mod unknown_constants;
mod weak_start;

pub use applicability::{NotJoint, joint};
pub use description::Description;
pub use search_with_constants::SearchScope;
pub use structural::structurally_unidentifiable;

use std::sync::Arc;

use crate::constrained::constraint_check::{doubt_broken, doubt_equations};
use crate::doubts::dependent_states::doubt_dependent_states;
use crate::doubts::{pooling_rules, trajectory_rules};
use crate::interruption::{self, doubt_unassessed};
use crate::joint::constrained_search::{ConstrainedAnswer, SearchOutcome};
use crate::joint::constraint_doubts::{contradiction, doubts, refuse_contradiction};
use crate::joint::cubic_inputs::cubic_inputs;
use crate::joint::declared_delays::DeclaredDelays;
use crate::joint::joint_fit::JointFit;
use crate::joint::library_probe::probe_libraries;
use crate::joint::no_fit::measured_states;
use crate::joint::report::Report;
use crate::joint::search_with_constants::{Searched, search_with_constants, sketch_with_constants};
use crate::joint::unknown_constants::Constants;
use crate::known_terms::{fixed_terms, is_estimated_if_given, stated};
use crate::options::Options;
use crate::redundancy::doubt_redundant_equations;
use crate::refusal::Refusal;
use crate::selection::thresholds::TERM_SELECTION;
use crate::trajectory;
use crate::trajectory::{CubicInputs, Found, Law, Problem, RunNotFollowed};
use sidc_data::{Column, Dataset, Origin, Samples};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::Signal;
use sidc_progress::{EquationObserver, Observer, Stage};
use sidc_system::discovery::{BlockNormalEquations, Discovery, Failed, Rest, Status, Witness};

/// What is kept of a joint estimate so that it can be judged.
#[derive(Clone, Debug, Default)]
pub struct Fitted {
    /// All signals along the trajectory.
    pub samples: Samples,
    /// `None` if the records cannot be divided.
    pub stretches: Option<BlockNormalEquations>,
    /// `None` if nothing was fitted.
    pub description: Option<Description>,
}

/// Finds all equations of the system together, with all signals along the fitted trajectory. `None` if no support could be fitted.
///
/// # Errors
/// The readings contradict the constraints of the model.
pub fn discover_jointly(
    (model, libraries): (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Option<(Discovery, Fitted)>, Box<Refusal>> {
    let mut watcher = EquationObserver::new(observer);
    let discovery = Discovery::of(model);
    let (of, watcher) = ((model, libraries), &mut watcher);
    let conclude = |ended: Ended, watcher: &mut EquationObserver| match ended.searched.outcome {
        SearchOutcome::Answer(mut answer) => {
            let scales = hidden_states::settle_scales(&mut answer, watcher);
            // A search that was cut short shows no contradiction.
            if watcher.stop().is_none() {
                refuse_contradiction(&discovery, model, &answer, watcher)?;
            }
            let (discovery, found) =
                equations(model, discovery, (&answer, ended.curved.as_ref()), watcher);
            let (mut discovery, mut fitted) = weigh(model, discovery, (&answer, &found), watcher);
            let constants = &ended.searched.constants;
            fitted.description = Some(Description::of(
                &answer.fit,
                constants.sought().len(),
                watcher,
            ));
            ended.delays.state(model, &mut discovery);
            hidden_states::state(model, &answer.fit, &scales, &mut discovery);
            let known = (model, constants.sought());
            hidden_states::doubt(known, &answer.fit, &mut discovery, watcher);
            hidden_states::doubt_twins(model, &ended.searched.twins, &mut discovery);
            let fit = (&answer.fit.problem, &answer.fit.found);
            constants.state(model, (fit.0, fit.1), &mut discovery, watcher);
            Ok(Some((discovery, fitted)))
        }
        SearchOutcome::OnlyFree(free) => {
            let nothing_under = None;
            Err(contradiction(
                &discovery,
                model,
                &free,
                nothing_under,
                watcher,
            ))
        }
        SearchOutcome::Nothing => Ok(watcher.stop().map(|stop| {
            let failed = |law: &Law| Failed {
                target: law.target,
                reasons: vec![interruption::failure(stop)],
            };
            let mut discovery = discovery;
            discovery.failed = ended.laws.iter().map(failed).collect();
            (discovery, Fitted::default())
        })),
    };
    let data = (dataset, problem);
    search_jointly(None, of, data, options, watcher, conclude)
}

/// The equations that a short search finds, without evidence for them, and how well they describe the readings. `None` if nothing could be fitted.
///
/// It tells whether a model is worth a search of its own.
pub fn describe_jointly(
    (model, libraries): (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    scope: SearchScope,
    options: &Options,
    observer: &mut dyn Observer,
) -> Option<(Discovery, Description)> {
    let mut watcher = EquationObserver::new(observer);
    let of = (model, libraries);
    let conclude = |ended: Ended, watcher: &mut EquationObserver| {
        let SearchOutcome::Answer(mut answer) = ended.searched.outcome else {
            return None;
        };
        hidden_states::settle_scales(&mut answer, watcher);
        let constants = ended.searched.constants;
        let (mut discovery, _) = equations(
            model,
            Discovery::of(model),
            (&answer, ended.curved.as_ref()),
            watcher,
        );
        let fit = (&answer.fit.problem, &answer.fit.found);
        constants.state(model, (fit.0, fit.1), &mut discovery, watcher);
        let description = Description::of(&answer.fit, constants.sought().len(), watcher);
        watcher.stop().is_none().then_some((discovery, description))
    };
    let data = (dataset, problem);
    search_jointly(Some(scope), of, data, options, &mut watcher, conclude)
}

/// What a joint search ended with.
struct Ended<'a> {
    searched: Searched<'a>,
    delays: &'a DeclaredDelays,
    /// The alternative to inputs that are straight between their samples.
    curved: Option<CubicInputs>,
    laws: &'a [Law],
}

/// Settles delays, constants, terms and disturbances; by a short search, if its depth is given.
fn search_jointly<T>(
    scope: Option<SearchScope>,
    of: (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    options: &Options,
    watcher: &mut EquationObserver,
    conclude: impl FnOnce(Ended, &mut EquationObserver) -> T,
) -> T {
    let delays = declared_delays::estimate_delays(of, dataset, problem, options, watcher);
    let given = (dataset, problem);
    let (problem, dataset) = (delays.problem(problem), delays.dataset(of.0, dataset));
    let data = (dataset.as_ref(), problem.as_ref());
    let starts = constant_starts::constant_starts(of, data, (options, scope.is_some()), watcher);
    let searched = match scope {
        None => search_with_constants(of, data, starts, options, watcher),
        Some(scope) => sketch_with_constants(of, data, (starts, scope), options, watcher),
    };
    let curved = (searched.as_ref()).and_then(|s| cubic_inputs(given.1, &delays, s, watcher));
    if let Some((curved, true)) = &curved
        && curved.gain > TERM_SELECTION.tie
    {
        return search_jointly(
            scope,
            of,
            (given.0, &given.1.along_cubics()),
            options,
            watcher,
            conclude,
        );
    }
    let nothing = || Searched::new(SearchOutcome::Nothing, Constants::none());
    let ended = Ended {
        searched: searched.unwrap_or_else(nothing),
        delays: &delays,
        curved: curved.map(|c| c.0),
        laws: &problem.system.laws,
    };
    conclude(ended, watcher)
}

/// The equations of an answer, and its fit with variances that include what interpolation of the inputs between their samples adds.
fn equations(
    model: &Model,
    mut discovery: Discovery,
    (answer, curved): (&ConstrainedAnswer, Option<&CubicInputs>),
    watcher: &mut EquationObserver,
) -> (Discovery, Found) {
    let stopped = watcher.stop();
    let JointFit {
        problem,
        found,
        late,
        lag,
        offset,
        white_noise_answer: _,
    } = &answer.fit;
    let mut found = found.clone();
    let problem = problem.as_ref();
    if let Some(curved) = curved {
        curved.widen(&mut found);
    }
    let report = Report {
        model,
        problem,
        found: &found,
        late: late.as_ref(),
        lag: lag.as_ref(),
        offset: offset.as_ref(),
        channels: trajectory::channels(problem, &found.best),
    };
    for law in &problem.system.laws {
        let right = &model.equations[law.equation].right;
        let known = fixed_terms(right);
        if law.columns.is_empty() && !is_estimated_if_given(model, right) {
            discovery.equations.push(stated(law.target, known));
            continue;
        }
        let mut equation = report.equation(&discovery, law, known);
        equation.reasons.extend(stopped.map(interruption::doubt));
        if !equation.reasons.is_empty() {
            equation.status = Status::Doubt;
        }
        discovery.equations.push(equation);
    }
    (discovery, found)
}

/// The equations with the evidence against them: doubts, and what later checks need.
fn weigh(
    model: &Model,
    mut discovery: Discovery,
    (answer, found): (&ConstrainedAnswer, &Found),
    watcher: &mut EquationObserver,
) -> (Discovery, Fitted) {
    let stopped = watcher.stop();
    let problem = answer.fit.problem.as_ref();
    discovery.rests = rests(problem);
    doubt_runs(
        &mut discovery,
        (model, problem),
        (found, &answer.not_followed),
        watcher,
    );
    if stopped.is_none() && watcher.at(Stage::Weighing).is_none() {
        let better = probe_libraries(problem, found, watcher);
        trajectory_rules::doubt_libraries(&mut discovery, (model, problem), better.as_ref());
    }
    let samples = samples(model, problem, found);
    let witness = Arc::new(Witness {
        path: Some(Arc::new(samples.clone())),
        ..Witness::default()
    });
    for evidence in discovery.equations.iter_mut().flat_map(|e| &mut e.evidence) {
        evidence.witness = Some(witness.clone());
    }
    doubt_redundant_equations(&mut discovery, &samples, None);
    doubt_dependent_states(&mut discovery, &measured_states(problem), &offered(problem));
    let constrained = doubts(&discovery, model, answer, watcher);
    for (constraint, reason) in &constrained {
        doubt_equations(&mut discovery, constraint, reason);
    }
    doubt_broken(&mut discovery, model);
    // Where constraints shape the answer, changes of single terms would break them. A scale that was set for a hidden state is such a
    // constraint.
    let free_scale =
        !problem.system.hidden.is_empty() && !problem.system.constraints.rows.is_empty();
    let stretches = match watcher.at(Stage::Weighing) {
        None if answer.free.is_none() && !free_scale => {
            likelihood_by_stretch(problem, found, watcher)
        }
        _ => None,
    };
    if let Some(stop) = watcher.stop() {
        doubt_unassessed(&mut discovery, 0, stop);
    }
    let fitted = Fitted {
        samples,
        stretches,
        description: None,
    };
    (discovery, fitted)
}

/// Doubts about the runs: those that are not followed, and coefficients that differ between the others.
fn doubt_runs(
    discovery: &mut Discovery,
    (model, problem): (&Model, &Problem),
    (found, left_out): (&Found, &[RunNotFollowed]),
    watcher: &mut EquationObserver,
) {
    let used = problem.runs();
    let not_followed = pooling_rules::not_followed(problem, &used, left_out, &model.time_unit());
    if let Some(reason) = not_followed {
        discovery.doubt_each(|_, _| Some(reason.clone()));
    }
    discovery.doubt_each(|names, equation| pooling_rules::undeclared(model, names, equation));
    discovery.runs_left = (left_out.iter())
        .filter_map(|l| problem.names.get(l.trajectory).cloned())
        .collect();
    // Where the answer already has undeclared coefficients for each run, no others are looked for.
    let split = pooling_rules::has_undeclared(model, discovery);
    if split || used.len() < 2 || watcher.at(Stage::Weighing).is_some() {
        return;
    }
    let differing =
        trajectory::differing_coefficients(problem, &found.best, found.inefficiency, watcher);
    for one in &differing {
        let reason = pooling_rules::differs((model, discovery), problem, one);
        let law = &problem.system.laws[problem.system.law_of(one.column)];
        let mut all = discovery.equations.iter_mut();
        if let Some(equation) = all.find(|e| e.target == law.target) {
            equation.doubt(reason);
        }
    }
}

/// The parts of runs that no law was fitted to.
fn rests(problem: &Problem) -> Vec<Rest> {
    let rest = |r: &trajectory::model::Rest| Rest {
        run: problem.names[r.trajectory].clone(),
        from: r.time[0],
        to: r.time[1],
    };
    problem.rests.iter().map(rest).collect()
}

/// The signals among the candidates of each law.
fn offered(problem: &Problem) -> Vec<(Signal, Vec<Signal>)> {
    let system = &problem.system;
    let of = |law: &Law| {
        let mut signals = Vec::new();
        for term in law.columns.clone().map(|j| problem.term(j)) {
            term.for_each_signal(&mut |s| signals.push(s));
        }
        signals.sort_unstable();
        signals.dedup();
        (law.target, signals)
    };
    system.laws.iter().map(of).collect()
}

/// The quadratic form of the likelihood about the answer, stretch by stretch.
fn likelihood_by_stretch(
    problem: &Problem,
    found: &Found,
    observer: &mut dyn Observer,
) -> Option<BlockNormalEquations> {
    let pieces = trajectory::block_products(problem, &found.best, found.inefficiency, observer)?;
    let system = &problem.system;
    let column = |j: &usize| {
        let law = &system.laws[system.law_of(*j)];
        (law.target, system.columns[*j].clone())
    };
    let support = found.best.support().iter();
    let readings = problem.measurements() as f64 / found.inefficiency;
    Some(BlockNormalEquations {
        columns: pieces.columns.iter().map(column).collect(),
        support: support
            .filter_map(|j| pieces.columns.binary_search(j).ok())
            .collect(),
        products: pieces.products,
        whole: pieces.whole,
        readings,
        price: (
            trajectory::term_price(readings),
            trajectory::term_price(0.5 * readings),
        ),
    })
}

/// All signals along the fitted trajectory.
fn samples(model: &Model, problem: &Problem, found: &Found) -> Samples {
    let signals = problem.system.evaluation_signals();
    let rows = problem.values(&found.best);
    let mut columns: Vec<Column> = signals
        .iter()
        .zip(rows)
        // What only marks a run is no signal of the model.
        .filter(|(signal, _)| model.var(signal.var).is_some())
        .map(|(signal, values)| Column {
            signal: *signal,
            values,
            origin: Origin::Measured { noise: None },
        })
        .collect();
    columns.sort_by_key(|c| c.signal);
    Samples {
        trajectory: (problem.records.iter())
            .flat_map(|r| r.time.iter().map(|_| r.trajectory as u32))
            .collect(),
        time: problem
            .records
            .iter()
            .flat_map(|r| r.time.clone())
            .collect(),
        columns,
    }
}
