//! Whether laws with disturbances take the place of laws without.
//!
//! In: a problem, the answer without disturbances, if there is one. Out: the answer with them, or nothing. Never writes messages.

use crate::doubts::trajectory_rules;
use crate::joint::constrained_search::{ConstrainedAnswer, Settled};
use crate::joint::delay_outlier_search::search_with_disturbances;
use crate::joint::joint_fit::{JointFit, unexplained};
use crate::joint::library_probe::probe_libraries;
use crate::joint::no_fit::still;
use crate::trajectory;
use crate::trajectory::{AHEAD, Disturbance, Problem, ProcessNoise};
use sidc_lang::model::Model;
use sidc_lang::term::Signal;
use sidc_progress::EquationObserver;

/// What a search ended with, with disturbances where they explain what it leaves, or where it ended with nothing.
pub(crate) fn with_disturbances<'a>(
    of: (&Model, &Problem),
    settled: Settled<'a>,
    watcher: &mut EquationObserver,
) -> Settled<'a> {
    match settled {
        Settled::Answer(mut answer) => {
            if let Some(fit) = disturbed(of, Some(&answer), watcher) {
                answer.fit = fit;
            }
            Settled::Answer(answer)
        }
        Settled::Nothing => match disturbed(of, None, watcher) {
            None => Settled::Nothing,
            Some(fit) => Settled::Answer(Box::new(ConstrainedAnswer {
                fit,
                free: None,
                left: Vec::new(),
            })),
        },
        Settled::OnlyFree(free) => Settled::OnlyFree(free),
    }
}

/// The fit with disturbances where that is the best explanation of what the answer leaves: the innovations are white, as those of the
/// right laws with the right disturbances are, and no standard terms explain the same. A disturbance that lasts may also stand for what the
/// laws lack. So it has to be smaller than the target that it drives, and, against laws without it, to make do with no more terms that by
/// themselves, from the same states, predict as well. Where constraints shape the answer none is looked for: what it leaves is theirs.
///
/// Inputs whose noise is declared are estimated too, whatever is left without that.
fn disturbed<'a>(
    (model, problem): (&Model, &Problem),
    answer: Option<&ConstrainedAnswer>,
    watcher: &mut EquationObserver,
) -> Option<JointFit<'a>> {
    let known = answer.map_or(problem, |a| &a.fit.problem);
    let inputs = noisy_inputs(model, known);
    if !inputs.is_empty() && answer.is_none_or(|a| a.free.is_none()) {
        // The filter that estimates inputs knows white noise of sensors only.
        let noisy = known.with_noise_memory(&[]).with_noisy_inputs(&inputs);
        let fit = search_with_disturbances(&noisy, (answer.map(|a| &a.fit), 0.0), watcher)?;
        return watcher.stop().is_none().then_some(fit);
    }
    let settled =
        |a: &ConstrainedAnswer| a.free.is_some() || a.fit.white.is_none() && explained(&a.fit);
    if watcher.stop().is_some() || answer.is_some_and(settled) {
        return None;
    }
    // Against noise that lasts nothing is to be weighed where the model declares it.
    if problem.declares_memory() || answer.is_none() && !still(problem).is_empty() {
        return None;
    }
    // Noise of sensors that lasts leaves the trajectory alone, disturbances move it: the likelihood tells which it is.
    let before = answer.map(|a| a.fit.white.as_deref().unwrap_or(&a.fit));
    let gained = answer.and_then(|a| Some(a.fit.gain_over(a.fit.white.as_deref()?)));
    let known = before.map_or(problem, |b| &b.problem);
    let fit = search_with_disturbances(known, (before, gained.unwrap_or(0.0)), watcher)?;
    let better = explained(&fit)
        && laws_prevail(problem, &fit)
        && before.is_none_or(|b| takes_the_place(b, &fit, watcher));
    (better && watcher.stop().is_none()).then_some(fit)
}

/// Held inputs whose noise is declared, with that noise.
fn noisy_inputs(model: &Model, problem: &Problem) -> Vec<(Signal, f64)> {
    let declared = model.noisy_inputs();
    let held = declared.filter(|(s, _)| problem.holds(*s));
    held.map(|(s, noise)| (s, noise.rms(&problem.values_of_input(s))))
        .collect()
}

fn explained(fit: &JointFit) -> bool {
    !unexplained(&fit.problem, &fit.found.best)
}

/// Whether every disturbance that lasts varies less than what is left to the law of its target.
fn laws_prevail(problem: &Problem, fit: &JointFit) -> bool {
    let disturbances = fit.found.best.process().into_iter().flat_map(|p| &p.laws);
    disturbances.enumerate().all(|(l, d)| match d {
        Disturbance::White { .. } => true,
        Disturbance::FirstOrder { deviation, .. } => {
            2.0 * deviation.powi(2) < problem.rate_spread(l).powi(2)
        }
    })
}

fn takes_the_place(
    before: &JointFit,
    disturbed: &JointFit,
    watcher: &mut EquationObserver,
) -> bool {
    let best = &disturbed.found.best;
    let white = best.process().is_some_and(ProcessNoise::is_white);
    let fewer = best.support().len() <= before.found.best.support().len();
    (white || fewer && predicts_as_well(before, disturbed)) && !terms_explain(before, watcher)
}

/// Whether the laws with standard terms that their libraries lack leave only noise.
fn terms_explain(fit: &JointFit, watcher: &mut EquationObserver) -> bool {
    let better = probe_libraries(&fit.problem, &fit.found, watcher);
    better.is_some_and(|laws| !laws.channels.iter().any(trajectory_rules::unexplained))
}

/// Whether the laws of a fit with disturbances predict as well without these as those of a fit that knows none.
fn predicts_as_well(before: &JointFit, disturbed: &JointFit) -> bool {
    let best = &disturbed.found.best;
    let ahead = trajectory::own_time(&before.problem);
    let error = |fit: &JointFit| {
        trajectory::log_error_ahead(&fit.problem, &fit.found.best, best.paths(), ahead)
    };
    error(disturbed) <= error(before) + AHEAD.as_good.ln()
}
