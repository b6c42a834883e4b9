//! Whether laws with disturbances take the place of laws without.
//!
//! In: a problem, the answer without disturbances, if there is one. Out: the answer with them, or nothing. Never writes messages.

use crate::doubts::trajectory_rules;
use crate::joint::constrained_search::ConstrainedAnswer;
use crate::joint::delay_outlier_search::{JointFit, search_with_disturbances, unexplained};
use crate::joint::library_probe::probe_libraries;
use crate::joint::no_fit::still;
use crate::trajectory;
use crate::trajectory::{AHEAD, Problem, ProcessNoise};
use sidc_progress::EquationObserver;

/// The fit with disturbances where that is the best explanation of what the answer leaves: the innovations are white, as those of the
/// right laws with the right disturbances are; no standard terms explain it instead; and the laws alone, from the same states, predict
/// as well. Where no laws lead along the data, what drives them has to be white. Otherwise disturbances only stand for what the laws lack.
/// Where constraints shape the answer none is looked for: what it leaves is theirs.
pub(crate) fn disturbed<'a>(
    problem: &Problem,
    answer: Option<&ConstrainedAnswer>,
    watcher: &mut EquationObserver,
) -> Option<JointFit<'a>> {
    let explained = |fit: &JointFit| !unexplained(&fit.problem, &fit.found.best);
    let settled = |a: &ConstrainedAnswer| a.free.is_some() || explained(&a.fit);
    if watcher.stop().is_some() || answer.is_some_and(settled) {
        return None;
    }
    if answer.is_none() && !still(problem).is_empty() {
        return None;
    }
    let fit = search_with_disturbances(problem, answer.map(|a| &a.fit), watcher)?;
    let better = explained(&fit)
        && match answer {
            None => fit.found.best.process().is_some_and(ProcessNoise::is_white),
            Some(before) => {
                predicts_as_well(&before.fit, &fit) && !terms_explain(&before.fit, watcher)
            }
        };
    (better && watcher.stop().is_none()).then_some(fit)
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
