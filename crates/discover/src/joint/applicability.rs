//! Whether all equations are estimated together with their trajectory.
//!
//! In: a model, its libraries, a dataset, options. Out: the estimation problem with the constraints of the model, or why there is none
//! and whether the other method is the weaker one for such data. Fits nothing.

use crate::joint::declared_runs::{offer_per_run, with_declared_runs};
use crate::joint::stated_constraints::{coefficient_constraints, with_named_terms};
use crate::joint::thresholds::JOINT;
use crate::options::{Method, Options};
use crate::selection::screening::{CandidatePools, screen};
use crate::trajectory::{Channel, Problem, System};
use sidc_data as data;
use sidc_data::Dataset;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Language, Signal, SignalNames};
use sidc_progress::Observer;

/// Why equations are not estimated together with their trajectory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotJoint {
    /// In words that follow "because".
    pub because: String,
    /// Whether the readings are noisy and no rate was measured: the other method would differentiate them.
    pub weaker: bool,
}

impl NotJoint {
    /// Data for which the other method is as good.
    fn fine(because: impl Into<String>) -> NotJoint {
        NotJoint {
            because: because.into(),
            weaker: false,
        }
    }
}

/// The joint estimation problem, where it is asked for or, by default, where the data are noisy.
///
/// # Errors
/// Why there is none.
pub fn joint(
    model: &Model,
    libraries: &[Option<Library>],
    dataset: &Dataset,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Problem, NotJoint> {
    let by_run = !model.per_run.is_empty();
    let hidden = model.hidden_states().next().is_some();
    let jumps = !model.resets.is_empty();
    let needed = by_run
        || hidden
        || jumps
        || model.has_unknown_delays()
        || model.noisy_inputs().next().is_some();
    let asked = options.method == Method::Joint || needed && options.method == Method::Auto;
    if by_run && !model.constraints.is_empty() {
        return Err(NotJoint::fine("coefficients are constrained"));
    }
    if by_run && libraries.iter().flatten().any(|l| !l.required().is_empty()) {
        return Err(NotJoint::fine("terms are required"));
    }
    if needed && (options.samples.is_some() || options.path) {
        return Err(NotJoint::fine(
            "rows are to be drawn, or a path is to be shown",
        ));
    }
    if !asked {
        if options.method != Method::Auto {
            return Err(NotJoint::fine("another method was asked for"));
        }
        if let Some(target) = measured(model, dataset) {
            let target = model.name(target);
            return Err(NotJoint::fine(format!("{target} is measured")));
        }
        if !options.robust && plainly_clean(model, dataset) {
            return Err(clean());
        }
    }
    let declared = || {
        let mut states = states(model);
        states.any(|s| model.noise(s).is_some_and(|n| n.is_valid()))
    };
    let without_laws = |because| NotJoint {
        because,
        // In discrete time no derivative has to be estimated, so regression loses nothing to noise.
        weaker: !model.discrete && declared(),
    };
    let make = |pools: &CandidatePools| System::new(model, libraries, pools);
    // The noise of the sensors does not depend on the candidate terms, so one column for each equation is enough to estimate it.
    let bare = make(&libraries.iter().map(|_| Some(vec![0])).collect()).map_err(without_laws)?;
    let missing = |s: Signal| format!("the data have no {}", model.name(s));
    let noise = |s| model.noise(s);
    let bare = Problem::new(bare, dataset, &noise, options.robust);
    let bare = bare.map_err(|s| NotJoint::fine(missing(s)))?;
    let noisy = |c: &Channel| c.noise > JOINT.clean_data * c.spread;
    let noisy = bare.channels().iter().any(noisy) || !bare.left_out.is_empty();
    let not = |because: String| NotJoint {
        because,
        weaker: noisy,
    };
    if !asked && !noisy {
        return Err(clean());
    }
    if !asked && options.samples.is_some() {
        return Err(not("rows are to be drawn (--samples)".into()));
    }
    if !asked && options.path {
        return Err(not("a path is to be shown (--path)".into()));
    }
    let with = |system: System| bare.with_system(system, dataset, &noise, options.robust);
    let size = (bare.states(), bare.samples());
    let whole = |s| with(s).map_err(missing);
    let pools = screen(model, libraries, size, &whole, observer).map_err(not)?;
    let mut pools = with_named_terms(pools, model, libraries);
    offer_per_run(model, libraries, &mut pools);
    let system = make(&pools).map_err(not)?;
    let constraints = coefficient_constraints(model, libraries, &system);
    let problem = whole(system).map_err(not)?.under(constraints);
    let problem = problem.with_declared_memory(&|s| model.noise_time_constant(s));
    let problem = with_declared_runs(model, problem).with_defined_start(JOINT.outside_domain);
    if let Some(term) = problem.first_undefined_column() {
        let term = Language(model).term(term);
        return Err(not(format!("{term} has no finite value")));
    }
    Ok(problem)
}

fn clean() -> NotJoint {
    NotJoint::fine("the data are clean")
}

/// The first target that was measured.
fn measured(model: &Model, dataset: &Dataset) -> Option<Signal> {
    let mut targets = model.equations.iter().map(|e| e.target);
    targets.find(|s| dataset.has(*s))
}

/// The states of the equations: what is below each target.
fn states(model: &Model) -> impl Iterator<Item = Signal> {
    let below =
        |target: Signal| (0..target.der).map(move |der| Signal::derivative(target.var, der));
    model.equations.iter().flat_map(move |e| below(e.target))
}

/// Whether the readings of all states with a law are so smooth that there is no noise to look for. What a model says of its sensors
/// is not doubted.
fn plainly_clean(model: &Model, dataset: &Dataset) -> bool {
    let part = JOINT.vanishing_differences;
    let readings = |s: Signal| {
        let held = dataset.trajectories.iter().map(move |t| (t, t.column(s)));
        held.filter_map(|(t, column)| Some((&t.time, column?)))
    };
    let smooth = |s: Signal| readings(s).all(|(time, x)| data::is_smooth(time, x, part));
    states(model).all(|s| model.noise(s).is_none() && smooth(s))
}
