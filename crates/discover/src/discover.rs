//! The discovery of all equations from rows: one by one, or in groups where constraints couple them.
//!
//! In: a model, its libraries, samples. Out: a [`Discovery`], with the doubts that concern several equations together.

use std::collections::BTreeMap;

use crate::constrained::constraint_rows::{ConstraintRow, constraint_rows, coupled_groups};
use crate::constrained::coupled_equations::CoupledGroup;
use crate::constrained::{constraint_check, coupled_equations};
use crate::doubts::dependent_states::{doubt_dependent_states, states_in_samples};
use crate::interruption::doubt_unassessed;
use crate::known_terms::{fixed_terms, is_estimated_if_given, stated};
use crate::options::{Method, Options};
use crate::redundancy;
use crate::refusal::Refusal;
use crate::regression::task::Task;
use crate::regression::uncoupled::run_uncoupled;
use crate::regression::weak_regression::WeakSystem;
use sidc_data::{Dataset, Samples};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::Signal;
use sidc_progress::{EquationObserver, Observer};
use sidc_system::discovery::{Discovery, Equation, Failed};

/// Finds every equation of the model from rows of samples.
///
/// `libraries` has one entry for each equation, `None` where the model states the equation. Equations that share constraints are
/// solved together. If the observer ends the work, the equations found so far stand and the others are listed as failed.
///
/// ```
/// use sidc_data::Dataset;
/// use sidc_discover::{Options, discover};
/// use sidc_progress::Unwatched;
/// use sidc_system::discovery::Status;
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
/// let found = discover(&program.model, &program.libraries, data, &Options::default(), &mut Unwatched);
/// let found = found.map_err(|_| "a term has no value")?;
/// let equation = &found.equations[0];
/// assert_eq!((equation.status, equation.terms.len()), (Status::Pass, 1));
/// assert!((equation.terms[0].coefficient + 1.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Terms without a finite value on the data, one for each equation; constraints that the data contradict.
pub fn discover(
    model: &Model,
    libraries: &[Option<Library>],
    (dataset, samples): (&Dataset, &Samples),
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Discovery, Vec<Refusal>> {
    let mut discovery = Discovery::of(model);
    let mut watcher = EquationObserver::new(observer);
    let tied = constraint_rows(model, libraries);
    let groups = coupled_groups(&tied, model.equations.len());
    let task_with = |i: usize, library| -> Option<Task> {
        let equation = model.equations.get(i)?;
        Some(Task {
            target: equation.target,
            known: fixed_terms(&equation.right),
            library,
            model,
            dataset,
            samples,
            options,
        })
    };
    let task = |i: usize| Some((i, task_with(i, libraries.get(i)?.as_ref()?)?));
    let no_candidates = Library::default();
    let untied = |i: &usize| !groups.iter().any(|g| g.contains(i));
    let untied: Vec<usize> = (0..model.equations.len()).filter(untied).collect();
    let group = |members: &Vec<usize>| {
        let among = |t: &&ConstraintRow| t.row.entries.iter().any(|e| members.contains(&e.0));
        CoupledGroup {
            tasks: members.iter().filter_map(|m| task(*m)).collect(),
            tied: tied.iter().filter(among).collect(),
        }
    };

    let mut done: Vec<Option<Result<Equation, Failed>>> = vec![None; model.equations.len()];
    let (mut refused, mut doubts) = (Vec::new(), Vec::new());
    if options.method == Method::Weak {
        match WeakSystem::new(untied.iter().filter_map(|i| task(*i))) {
            Ok(system) => {
                for (i, found) in system.run(&discovery, &mut watcher) {
                    done[i] = Some(found);
                }
            }
            Err(values) => refused.extend(values.into_iter().map(Refusal::Unevaluable)),
        }
    }
    let open = untied.iter().filter(|i| done[**i].is_none());
    let open: Vec<(usize, Task)> = open.filter_map(|i| task(*i)).collect();
    let mut alone: BTreeMap<usize, _> = run_uncoupled(open, &discovery, &mut watcher)
        .into_iter()
        .collect();
    for (i, equation) in model.equations.iter().enumerate() {
        if done[i].is_some() {
            continue;
        }
        if !libraries.get(i).is_some_and(Option::is_some) {
            let read = samples.column(equation.target).is_some();
            let estimated = read && is_estimated_if_given(model, &equation.right);
            let given = task_with(i, &no_candidates).filter(|_| estimated);
            let as_stated = || stated(equation.target, fixed_terms(&equation.right));
            done[i] = Some(Ok(given.map_or_else(as_stated, |task| task.judge_given())));
            continue;
        }
        let Some(members) = groups.iter().find(|g| g.contains(&i)) else {
            match alone.remove(&i) {
                Some(Ok(found)) => done[i] = Some(found),
                Some(Err(value)) => refused.push(Refusal::Unevaluable((i, value))),
                None => {}
            }
            continue;
        };
        if members.first() != Some(&i) {
            continue;
        }
        match group(members).run(&discovery, &mut watcher) {
            Ok(concluded) => {
                doubts.extend(concluded.doubts);
                for (place, found) in concluded.done {
                    done[place] = Some(found);
                }
            }
            Err(refusals) => refused.extend(refusals),
        }
    }
    if !refused.is_empty() {
        return Err(refused);
    }
    for found in done.into_iter().flatten() {
        match found {
            Ok(equation) => discovery.equations.push(equation),
            Err(failed) => discovery.failed.push(failed),
        }
    }

    coupled_equations::attach(&mut discovery, &doubts);
    let refit = redundancy::Refit {
        tasks: untied.iter().filter_map(|i| Some(task(*i)?.1)).collect(),
        watcher: &mut watcher,
    };
    redundancy::doubt_redundant_equations(&mut discovery, samples, Some(refit));
    let offered: Vec<(Signal, Vec<Signal>)> = model
        .equations
        .iter()
        .zip(libraries)
        .filter_map(|(e, library)| Some((e.target, library.as_ref()?.signals())))
        .collect();
    doubt_dependent_states(&mut discovery, &states_in_samples(model, samples), &offered);
    constraint_check::doubt_broken(&mut discovery, model);
    if let Some(stop) = watcher.stop().filter(|_| !discovery.was_stopped()) {
        doubt_unassessed(&mut discovery, 0, stop);
    }
    Ok(discovery)
}
