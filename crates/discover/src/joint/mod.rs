//! Joint estimation of all equations with their trajectory: when it applies, and its result as a discovery.
//!
//! In: a model, its libraries, a dataset. Out: the estimation problem, or why there is none; then equations with their evidence.
//! Never estimates anything itself; `crate::trajectory` does.

mod delay_outlier_search;
mod library_probe;
pub(crate) mod no_fit;
mod pooled_search;
mod report;
pub(crate) mod thresholds;
mod weak_start;

use std::sync::Arc;

use crate::doubts::dependent_states::doubt_dependent_states;
use crate::doubts::{pooling_rules, trajectory_rules};
use crate::early_stop::{self, doubt_unassessed};
use crate::joint::delay_outlier_search::JointFit;
use crate::joint::library_probe::probe_libraries;
use crate::joint::no_fit::measured_states;
use crate::joint::pooled_search::{PooledFit, search_runs};
use crate::joint::report::Report;
use crate::joint::thresholds::JOINT;
use crate::joint::weak_start::weak_start;
use crate::known_terms::{fixed_terms, stated};
use crate::options::{Method, Options};
use crate::redundancy::doubt_redundant_equations;
use crate::selection::screening::{CandidatePools, screen};
use crate::trajectory;
use crate::trajectory::{Channel, Found, Law, Left, Problem, System};
use sidc_data as data;
use sidc_data::{Column, Dataset, Origin, Samples};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Language, Signal, SignalNames};
use sidc_progress::{EquationObserver, Observer, Stage};
use sidc_system::discovery::{Discovery, Failed, Status, Stretches, Witness};

/// The joint estimation problem, where it is asked for or, by default, where the data are noisy.
///
/// # Errors
/// Why there is none, in words that follow "because".
pub fn joint(
    model: &Model,
    libraries: &[Option<Library>],
    dataset: &Dataset,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Problem, String> {
    let by_run = !model.per_run.is_empty();
    let asked = options.method == Method::Joint || by_run && options.method == Method::Auto;
    if !asked && options.method != Method::Auto {
        return Err("another method was asked for".into());
    }
    if options.method == Method::Auto && (options.samples.is_some() || options.path) {
        return Err("rows are to be drawn, or a path is to be shown".into());
    }
    if !model.constraints.is_empty() {
        return Err("coefficients are constrained".into());
    }
    if !asked && let Some(target) = measured(model, dataset) {
        return Err(format!("{} is measured", model.name(target)));
    }
    let make = |pools: &CandidatePools| System::new(model, libraries, pools);
    let clean = || "the data are clean".to_owned();
    if !asked && !options.robust && plainly_clean(model, dataset) {
        return Err(clean());
    }
    // The noise shows with one column for each equation, which is quick to set up.
    let bare = make(&libraries.iter().map(|_| Some(vec![0])).collect())?;
    let missing = |s: Signal| format!("the data have no {}", model.name(s));
    let noise = |s| model.noise(s);
    let bare = Problem::new(bare, dataset, &noise, options.robust).map_err(missing)?;
    let noisy = |c: &Channel| c.noise > JOINT.clean_data * c.spread;
    let noisy = bare.channels().iter().any(noisy) || !bare.left_out.is_empty();
    if !asked && !noisy {
        return Err(clean());
    }
    let with = |system: System| bare.with_system(system, dataset, &noise, options.robust);
    let size = (bare.states(), bare.samples());
    let mut pools = screen(
        model,
        libraries,
        size,
        &|s| with(s).map_err(missing),
        observer,
    )?;
    offer_per_run(model, libraries, &mut pools);
    let problem = with(make(&pools)?).map_err(missing)?;
    let problem = with_declared_runs(model, problem);
    if let Some(term) = problem.first_undefined_column() {
        return Err(format!(
            "{} has no finite value",
            Language(model).term(term)
        ));
    }
    Ok(problem)
}

/// Keeps the terms whose coefficients may differ between runs among the candidates.
fn offer_per_run(model: &Model, libraries: &[Option<Library>], pools: &mut CandidatePools) {
    for c in &model.per_run {
        let place = model.equations.iter().position(|e| e.target == c.target);
        let Some(place) = place else { continue };
        let slot = libraries[place].as_ref().and_then(|l| l.contains(&c.term));
        if let (Some(slot), Some(Some(pool))) = (slot, pools.get_mut(place))
            && let Err(at) = pool.binary_search(&slot)
        {
            pool.insert(at, slot);
        }
    }
}

/// The problem with a coefficient for each run where the model says so.
fn with_declared_runs(model: &Model, problem: Problem) -> Problem {
    let declared = |law: &Law, j: usize| {
        let term = &problem.system.columns[j];
        (model.per_run.iter()).any(|c| c.target == law.target && c.term == *term)
    };
    let laws = problem.system.laws.iter();
    let split: Vec<usize> = laws
        .flat_map(|law| law.columns.clone().filter(move |j| declared(law, *j)))
        .collect();
    match split.is_empty() {
        true => problem,
        false => problem.with_run_columns(&split).0,
    }
}

/// The first target that was measured.
fn measured(model: &Model, dataset: &Dataset) -> Option<Signal> {
    let mut targets = model.equations.iter().map(|e| e.target);
    targets.find(|s| dataset.has(*s))
}

/// Whether the readings of all states with a law are so smooth that there is no noise to look for. What a model says of its sensors
/// is not doubted.
fn plainly_clean(model: &Model, dataset: &Dataset) -> bool {
    let part = JOINT.vanishing_differences;
    let readings = |s: Signal| {
        let held = dataset.trajectories.iter().map(move |t| (t, t.column(s)));
        held.filter_map(|(t, column)| Some((&t.time, column?)))
    };
    let below =
        |target: Signal| (0..target.der).map(move |der| Signal::derivative(target.var, der));
    let mut states = model.equations.iter().flat_map(|e| below(e.target));
    let smooth = |s: Signal| readings(s).all(|(time, x)| data::is_smooth(time, x, part));
    states.all(|s| model.noise(s).is_none() && smooth(s))
}

/// What is kept of a joint estimate so that it can be judged.
#[derive(Clone, Debug, Default)]
pub struct Fitted {
    /// All signals along the trajectory.
    pub samples: Samples,
    /// `None` if the records cannot be divided.
    pub stretches: Option<Stretches>,
}

/// Finds all equations of the system together, with all signals along the fitted trajectory. `None` if no support could be fitted.
pub fn discover_jointly(
    (model, libraries): (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    options: &Options,
    observer: &mut dyn Observer,
) -> Option<(Discovery, Fitted)> {
    let mut watcher = EquationObserver::new(observer);
    let mut discovery = Discovery::of(model);
    let start = weak_start((model, libraries), dataset, problem, options, &mut watcher);
    let settled = search_runs((model, problem), start, options, &mut watcher);
    let stopped = watcher.stop();
    let Some(PooledFit {
        fit:
            JointFit {
                problem,
                mut found,
                late,
                offset,
            },
        left,
    }) = settled
    else {
        let stop = stopped?;
        for law in &problem.system.laws {
            discovery.failed.push(Failed {
                target: law.target,
                reasons: vec![early_stop::failure(stop)],
            });
        }
        return Some((discovery, Fitted::default()));
    };
    let problem = problem.as_ref();
    trajectory::widen_by_interpolation(problem, &mut found, &mut watcher);
    let report = Report {
        model,
        problem,
        found: &found,
        late: late.as_ref(),
        offset: offset.as_ref(),
        channels: trajectory::channels(problem, &found.best),
    };
    for law in &problem.system.laws {
        let known = fixed_terms(&model.equations[law.equation].right);
        if law.columns.is_empty() {
            discovery.equations.push(stated(law.target, known));
            continue;
        }
        let mut equation = report.equation(&discovery, law, known);
        equation.reasons.extend(stopped.map(early_stop::doubt));
        if !equation.reasons.is_empty() {
            equation.status = Status::Doubt;
        }
        discovery.equations.push(equation);
    }
    doubt_runs(
        &mut discovery,
        (model, problem),
        (&found, &left),
        &mut watcher,
    );
    if stopped.is_none() && watcher.at(Stage::Weighing).is_none() {
        let better = probe_libraries(problem, &found, &mut watcher);
        trajectory_rules::doubt_libraries(&mut discovery, (model, problem), better.as_ref());
    }
    let samples = samples(model, problem, &found);
    let witness = Arc::new(Witness {
        path: Some(Arc::new(samples.clone())),
        ..Witness::default()
    });
    for evidence in discovery.equations.iter_mut().flat_map(|e| &mut e.evidence) {
        evidence.witness = Some(witness.clone());
    }
    doubt_redundant_equations(&mut discovery, &samples, None);
    doubt_dependent_states(&mut discovery, &measured_states(problem), &offered(problem));
    let stretches = match watcher.at(Stage::Weighing) {
        None => likelihood_by_stretch(problem, &found, &mut watcher),
        Some(_) => None,
    };
    if let Some(stop) = watcher.stop() {
        doubt_unassessed(&mut discovery, 0, stop);
    }
    Some((discovery, Fitted { samples, stretches }))
}

/// Doubts about the runs: those that are not followed, and coefficients that differ between the others.
fn doubt_runs(
    discovery: &mut Discovery,
    (model, problem): (&Model, &Problem),
    (found, left): (&Found, &[Left]),
    watcher: &mut EquationObserver,
) {
    let used = problem.runs();
    let not_followed = pooling_rules::not_followed(problem, &used, left);
    if let Some(reason) = not_followed {
        discovery.doubt_each(|_, _| Some(reason.clone()));
    }
    discovery.doubt_each(|names, equation| pooling_rules::undeclared(model, names, equation));
    discovery.runs_left = (left.iter())
        .filter_map(|l| problem.names.get(l.trajectory).cloned())
        .collect();
    // A second cause is looked for where the runs share all coefficients that nobody said to differ.
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
) -> Option<Stretches> {
    let pieces = trajectory::block_products(problem, &found.best, found.inefficiency, observer)?;
    let system = &problem.system;
    let column = |j: &usize| {
        let law = &system.laws[system.law_of(*j)];
        (law.target, system.columns[*j].clone())
    };
    let support = found.best.support().iter();
    let readings = problem.measurements() as f64 / found.inefficiency;
    Some(Stretches {
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
