//! A second method for equations that regression of measured rates leaves in doubt: joint estimation of all equations and their trajectory, as if the rates
//! had not been measured.
//!
//! In: a program, its measured signals, the equations of the first method. Out: the equations of the method that passes, with a record of both. A method that
//! the user chose is the only one tried. Equations of clean records are not estimated again: there regression sees smaller errors.

use sidc_data::Dataset;
use sidc_discover as discover;
use sidc_discover::Method;
use sidc_discover::identifiability::leaves_motion;
use sidc_discover::trajectory::Problem;
use sidc_lang::term::Signal;
use sidc_progress::Observer;
use sidc_system::discovery::{Discovery, MethodComparison, ReasonCode};

use super::joint::jointly;
use super::measure::Measured;
use super::program::Program;
use crate::options::Options;

/// The first equations, or those of the joint estimate if only these pass.
pub(super) fn passing_method(
    program: &Program,
    measured: &Measured,
    options: &Options,
    mut first: Discovery,
    observer: &mut dyn Observer,
) -> Discovery {
    if first.passes() || !options.search.chooses_way() || !doubts_concern_data(&first) {
        return first;
    }
    if library_is_insufficient(program, measured, &first) {
        return first;
    }
    let Some(dataset) = without_targets(program, &measured.dataset) else {
        return first;
    };
    let Some(problem) = problem(program, &dataset, options, observer) else {
        return first;
    };
    // If the readings alone contradict the constraints, the first answer is kept.
    let Ok((mut second, _)) = jointly(program, &dataset, &problem, options, observer) else {
        return first;
    };
    let holds = second.passes();
    let name = |method: Method| method.chosen().to_owned();
    let (regression, joint) = (name(Method::Regression), name(Method::Joint));
    let ways = MethodComparison {
        first: regression.clone(),
        first_doubts: first.doubt_codes(),
        second: joint.clone(),
        second_doubts: second.doubt_codes(),
        given: if holds { joint } else { regression },
    };
    let given = if holds { &mut second } else { &mut first };
    given.record_ways(&ways);
    if holds { second } else { first }
}

/// Whether the doubts are about what the data show, not about limits, stops or a solver, chosen by the user, that proves nothing.
fn doubts_concern_data(first: &Discovery) -> bool {
    use ReasonCode::{
        HeuristicSolver, Interrupted, MemoryLimit, NoMotion, SolverRefused, TimeLimit,
    };
    let others = [
        HeuristicSolver,
        Interrupted,
        MemoryLimit,
        NoMotion,
        SolverRefused,
        TimeLimit,
    ];
    first.doubt_codes().iter().all(|c| !others.contains(c))
}

/// Whether rates that agree with their states have motion that the library cannot explain. Then the joint estimate cannot explain it either.
fn library_is_insufficient(program: &Program, measured: &Measured, first: &Discovery) -> bool {
    let poor = |target: Signal| {
        let doubted = first.equations.iter().filter(|e| e.target == target);
        let mut reasons = doubted.flat_map(|e| &e.reasons);
        reasons.any(|r| r.code == ReasonCode::PoorFit)
    };
    let stated = program.model.equations.iter().zip(&program.libraries);
    let mut sought = stated.filter_map(|(e, library)| Some((e.target, library.as_ref()?)));
    measured.dataset.rate_faults.is_empty()
        && sought.any(|(target, library)| {
            poor(target) && leaves_motion(library, target, &measured.samples)
        })
}

/// The data as if no target had been measured; `None` if none was.
fn without_targets(program: &Program, dataset: &Dataset) -> Option<Dataset> {
    let equations = program.model.equations.iter();
    let targets: Vec<Signal> = equations.map(|e| e.target).collect();
    let measured = targets.iter().any(|s| dataset.has(*s));
    measured.then(|| dataset.without(&targets))
}

/// The joint problem of all equations; `None` if the program would not estimate such data jointly, or if a candidate only restates its target.
fn problem(
    program: &Program,
    dataset: &Dataset,
    options: &Options,
    observer: &mut dyn Observer,
) -> Option<Problem> {
    let (model, libraries, search) = (&program.model, &program.libraries, &options.search);
    let problem = discover::joint(model, libraries, dataset, search, observer).ok()?;
    problem.target_copies().is_empty().then_some(problem)
}
