//! Delays that nobody declared: which inputs may have one, and how large it is to a fraction of a sample.
//!
//! In: a problem without the delay, a fit with a delay in whole or quarter samples. Out: the likeliest delay near it, with its interval. Searches no terms.

use crate::joint::joint_fit::JointFit;
use crate::trajectory::{AppliedDelay, DelayedInputs, Problem, is_held, profile_delays};
use sidc_lang::model::{Model, Var, VarKind};
use sidc_lang::term::VarId;
use sidc_progress::EquationObserver;

/// The delay of one input within a sample of that of the fit, by the profile of the likelihood of its terms. Held inputs, which are
/// commands, are late by whole samples where the readings do not tell otherwise. `None` if the readings do not tell it, or prefer one beyond.
pub(crate) fn refined_delay(
    problem: &Problem,
    fit: &JointFit,
    watcher: &mut EquationObserver,
) -> Option<DelayedInputs> {
    let late = fit.late.as_ref()?;
    let [input] = late.inputs[..] else {
        return None;
    };
    let step = late.seconds / late.samples;
    let delay = AppliedDelay {
        var: input,
        seconds: late.seconds,
        range: ((late.seconds - step).max(0.0), late.seconds + step),
    };
    let at = (fit.problem.as_ref(), &fit.found.best);
    let profile = profile_delays(problem, &[delay], at, fit.found.inefficiency, watcher)?;
    let estimate = profile.first().filter(|e| !e.at_end && !e.is_open())?;
    let (from, to) = estimate.interval;
    let whole = is_held(problem, &late.inputs) && (from..=to).contains(&late.seconds);
    let seconds = match whole {
        true => late.seconds,
        false => estimate.delay.seconds,
    };
    Some(DelayedInputs {
        samples: seconds / step,
        seconds,
        interval: Some(estimate.interval),
        ..late.clone()
    })
}

/// Inputs that the laws may contain, that are not constant and whose delay the model does not declare.
pub(crate) fn undeclared(model: &Model, problem: &Problem) -> Vec<VarId> {
    let moves = |place: usize| {
        let columns = problem
            .records
            .iter()
            .filter_map(|r| r.exogenous.get(place));
        let moving = |v: &[f64]| v.windows(2).any(|w| w[0] != w[1]);
        columns.into_iter().any(|o| moving(&o.values))
    };
    let signals = problem.system.exogenous.iter().enumerate();
    let mut found: Vec<VarId> = signals
        .filter(|(place, s)| {
            let undeclared = |v: &&Var| v.kind == VarKind::Input && v.delay.is_none();
            model.var(s.var).filter(undeclared).is_some() && moves(*place)
        })
        .map(|(_, s)| s.var)
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}
