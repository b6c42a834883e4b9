//! Whether laws with disturbances replace the answer without them.
//!
//! In: a problem, the answer without disturbances, if there is one. Out: the answer with them, or nothing. Never writes messages.

use crate::doubts::trajectory_rules;
use crate::joint::constrained_search::{ConstrainedAnswer, SearchOutcome};
use crate::joint::delay_outlier_search::search_with_disturbances;
use crate::joint::joint_fit::{JointFit, unexplained};
use crate::joint::library_probe::probe_libraries;
use crate::joint::no_fit::still;
use crate::joint::thresholds::JOINT;
use crate::trajectory;
use crate::trajectory::{AHEAD, Disturbance, Problem, ProcessNoise};
use sidc_lang::model::Model;
use sidc_lang::term::Signal;
use sidc_progress::EquationObserver;

/// The outcome of a search, with disturbances where these explain what it leaves, or where it found nothing.
pub(crate) fn with_disturbances<'a>(
    of: (&Model, &Problem),
    outcome: SearchOutcome<'a>,
    watcher: &mut EquationObserver,
) -> SearchOutcome<'a> {
    match outcome {
        SearchOutcome::Answer(mut answer) => {
            if let Some(fit) = disturbed(of, Some(&answer), watcher) {
                answer.fit = fit;
            }
            SearchOutcome::Answer(answer)
        }
        SearchOutcome::Nothing => match disturbed(of, None, watcher) {
            None => SearchOutcome::Nothing,
            Some(fit) => SearchOutcome::Answer(Box::new(ConstrainedAnswer {
                fit,
                free: None,
                not_followed: Vec::new(),
            })),
        },
        SearchOutcome::OnlyFree(free) => SearchOutcome::OnlyFree(free),
    }
}

/// The fit with disturbances, if three conditions hold: its innovations are white, as they are for the right laws and disturbances, or far whiter; every
/// disturbance with a memory varies less than its target, since it may stand for what the laws lack; and standard terms outside the
/// libraries do not explain the same. A disturbance with a memory must also make do with no more terms than the laws without disturbances,
/// and these terms alone must predict as well from the same states. Where constraints shape the answer no disturbance is sought: the
/// constraints may cause the residuals.
///
/// Inputs whose noise is declared are estimated in any case.
fn disturbed<'a>(
    (model, problem): (&Model, &Problem),
    answer: Option<&ConstrainedAnswer>,
    watcher: &mut EquationObserver,
) -> Option<JointFit<'a>> {
    let known = answer.map_or(problem, |a| &a.fit.problem);
    let inputs = noisy_inputs(model, known);
    if !inputs.is_empty() && answer.is_none_or(|a| a.free.is_none()) {
        // The filter that estimates inputs allows white sensor noise only.
        let noisy = known.with_noise_memory(&[]).with_noisy_inputs(&inputs);
        let fit = search_with_disturbances(&noisy, (answer.map(|a| &a.fit), 0.0), watcher)?;
        return watcher.stop().is_none().then_some(fit);
    }
    // A disturbance would explain jumps that are off their place.
    if !problem.system.resets.is_empty() {
        return None;
    }
    let settled = |a: &ConstrainedAnswer| {
        a.free.is_some() || a.fit.white_noise_answer.is_none() && explained(&a.fit)
    };
    if watcher.stop().is_some() || answer.is_some_and(settled) {
        return None;
    }
    // Declared noise that lasts from sample to sample is no rival of disturbances: nothing is left to compare.
    if problem.declares_memory() || answer.is_none() && !still(problem).is_empty() {
        return None;
    }
    // Autocorrelated sensor noise does not move the trajectory, disturbances do: the likelihood tells them apart.
    let before = answer.map(|a| a.fit.white_noise_answer.as_deref().unwrap_or(&a.fit));
    let gained = answer.and_then(|a| Some(a.fit.gain_over(a.fit.white_noise_answer.as_deref()?)));
    let known = before.map_or(problem, |b| &b.problem);
    let fit = search_with_disturbances(known, (before, gained.unwrap_or(0.0)), watcher)?;
    let better = (explained(&fit) || before.is_some_and(|b| is_far_whiter(b, &fit)))
        && laws_dominate(problem, &fit)
        && before.is_none_or(|b| replaces_answer(b, &fit, watcher));
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

/// Whether white disturbances, with no more terms, leave innovations that are not white either, but far less autocorrelated than the residuals
/// without them. Autocorrelated residuals bias coefficients, so those with disturbances are the better ones; they stay doubted. Records with
/// the errors of another integrator are of this kind.
fn is_far_whiter(before: &JointFit, disturbed: &JointFit) -> bool {
    let autocorrelation = |fit: &JointFit| {
        let channels = trajectory::channels(&fit.problem, &fit.found.best).into_iter();
        channels.fold(0.0, |worst: f64, c| worst.max(c.autocorrelation.abs()))
    };
    let best = &disturbed.found.best;
    best.process().is_some_and(ProcessNoise::is_white)
        && best.support().len() <= before.found.best.support().len()
        && autocorrelation(disturbed) <= JOINT.far_whiter * autocorrelation(before)
}

/// Whether the variance of every disturbance with a memory is less than half of that of its target, so that the law explains the larger
/// part.
fn laws_dominate(problem: &Problem, fit: &JointFit) -> bool {
    let disturbances = fit.found.best.process().into_iter().flat_map(|p| &p.laws);
    disturbances.enumerate().all(|(l, d)| match d {
        Disturbance::White { .. } => true,
        Disturbance::FirstOrder { deviation, .. } => {
            2.0 * deviation.powi(2) < problem.rate_spread(l).powi(2)
        }
    })
}

fn replaces_answer(
    before: &JointFit,
    disturbed: &JointFit,
    watcher: &mut EquationObserver,
) -> bool {
    let best = &disturbed.found.best;
    let white = best.process().is_some_and(ProcessNoise::is_white);
    let fewer = best.support().len() <= before.found.best.support().len();
    (white || fewer && predicts_as_well(before, disturbed)) && !terms_explain(before, watcher)
}

/// Whether standard terms that the libraries lack leave only noise.
fn terms_explain(fit: &JointFit, watcher: &mut EquationObserver) -> bool {
    let better = probe_libraries(&fit.problem, &fit.found, watcher);
    better.is_some_and(|laws| !laws.channels.iter().any(trajectory_rules::unexplained))
}

/// Whether the laws of the fit with disturbances predict, without these, as well as the laws of the other fit.
fn predicts_as_well(before: &JointFit, disturbed: &JointFit) -> bool {
    let best = &disturbed.found.best;
    let ahead = trajectory::own_time(&before.problem);
    let error = |fit: &JointFit| {
        trajectory::log_error_ahead(&fit.problem, &fit.found.best, best.paths(), ahead)
    };
    error(disturbed) <= error(before) + AHEAD.as_good.ln()
}
