//! Whether an answer asks for inputs that run along cubics between their samples.
//!
//! In: a problem, its delays, what a search ended with. Out: the alternative, fitted to the terms found. Searches nothing.

use crate::joint::constrained_search::SearchOutcome;
use crate::joint::declared_delays::DeclaredDelays;
use crate::joint::joint_fit::unexplained;
use crate::joint::search_with_constants::Searched;
use crate::joint::thresholds::JOINT;
use crate::selection::thresholds::TERM_SELECTION;
use crate::trajectory::{
    AppliedDelay, CubicInputs, Found, Problem, profile_delays, sampling_interval,
};
use sidc_progress::EquationObserver;

/// What the readings say of inputs along cubics between their samples, and whether a search with them is possible.
pub(crate) fn cubic_inputs(
    problem: &Problem,
    delays: &DeclaredDelays,
    searched: &Searched,
    watcher: &mut EquationObserver,
) -> Option<(CubicInputs, bool)> {
    let SearchOutcome::Answer(answer) = &searched.outcome else {
        return None;
    };
    let fit = &answer.fit;
    let answered = (fit.problem.as_ref(), &fit.found);
    let mut all = delays.known();
    all.extend(fit.late.iter().flat_map(|l| l.applied()));
    // The problem without delays lacks the values of unknown constants and the courses of hidden states.
    let hidden = !fit.problem.system.hidden.is_empty();
    let lacking = hidden || !searched.constants.sought().is_empty();
    let (known, possible) = match lacking && !all.is_empty() {
        true => (&[][..], false),
        false => (&all[..], true),
    };
    let curved = CubicInputs::of(problem, [known, known], answered, watcher)?;
    let undecided = possible && !known.is_empty() && curved.gain <= TERM_SELECTION.tie;
    if undecided && unexplained(&fit.problem, &fit.found.best) {
        let retimed = retimed(problem, known, answered, watcher);
        let again =
            retimed.and_then(|d| CubicInputs::of(problem, [&d[0], &d[1]], answered, watcher));
        return Some((again.unwrap_or(curved), possible));
    }
    Some((curved, possible))
}

/// The delays, and the likeliest near them for inputs along cubics: delays fitted with straight inputs absorb the error of interpolation. Both are
/// to be compared on the same readings.
fn retimed(
    problem: &Problem,
    known: &[AppliedDelay],
    (at, found): (&Problem, &Found),
    watcher: &mut EquationObserver,
) -> Option<[Vec<AppliedDelay>; 2]> {
    let step = sampling_interval(problem)?;
    let around = |d: &AppliedDelay, by: f64| AppliedDelay {
        range: (d.seconds - by, d.seconds + by),
        ..*d
    };
    let near: Vec<AppliedDelay> = known
        .iter()
        .map(|d| around(d, JOINT.retimed * step))
        .collect();
    let profile = profile_delays(
        &problem.along_cubics(),
        &near,
        (at, &found.best),
        found.inefficiency,
        watcher,
    )?;
    let likeliest = profile.iter().zip(&near).map(|(e, near)| AppliedDelay {
        range: near.range,
        ..e.delay
    });
    Some([near.clone(), likeliest.collect()])
}
