//! Whether an answer asks for inputs that run along cubics between their samples.
//!
//! In: a problem, its delays, what a search ended with. Out: the alternative, fitted to the terms found. Searches nothing.

use crate::joint::constrained_search::SearchOutcome;
use crate::joint::declared_delays::DeclaredDelays;
use crate::joint::search_with_constants::Searched;
use crate::trajectory::{CurvedInputs, Problem};
use sidc_progress::EquationObserver;

/// What the readings say of inputs along cubics between their samples, and whether a search with them is possible.
pub(crate) fn curved_inputs(
    problem: &Problem,
    delays: &DeclaredDelays,
    searched: &Searched,
    watcher: &mut EquationObserver,
) -> Option<(CurvedInputs, bool)> {
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
    let curved = CurvedInputs::of(problem, known, answered, watcher)?;
    Some((curved, possible))
}
