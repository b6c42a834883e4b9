//! The search under constraints from an answer that breaks them.
//!
//! In: a problem with constraints, what was found without. Out: the best fit that obeys them, and its rivals. The trajectory of the free
//! answer is kept as the start: it follows the readings, whatever the constraints are.

use super::constrained_supports::{ConstrainedForm, minimum};
use super::search_observer::SearchObserver;
use super::support_search::{Found, Plan, continuation, fit_given};
use crate::trajectory::likelihood::set_variances;
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::residuals::statistical_inefficiency;
use crate::trajectory::thresholds::SEARCH;

/// Searches supports that satisfy the constraints, from an answer found without them. `None` if none could be fitted.
pub fn search_from_fit(
    problem: &Problem,
    free: &Found,
    observer: &mut dyn SearchObserver,
) -> Option<Found> {
    if problem.system.columns.is_empty() {
        return fit_given(problem, free.best.point.clone(), observer);
    }
    let starts = starts(problem, free, observer);
    // On long records only supports near the answer are fitted, as in a search without constraints.
    let plan = |inefficiency| match problem.searched_in_parts() {
        true => Plan::last_level(inefficiency).near(),
        false => Plan::last_level(inefficiency),
    };
    let mut found = continuation(problem, starts, plan(free.inefficiency), observer)?;
    let inefficiency = statistical_inefficiency(problem, &found.best);
    // Constraints may exclude the right laws; the residuals then last longer, fewer readings count as independent, and a term has
    // another price.
    if inefficiency > SEARCH.max_inefficiency.max(free.inefficiency) && observer.go_on() {
        let start = vec![found.best.point.clone()];
        if let Some(again) = continuation(problem, start, plan(inefficiency), observer) {
            let tried = found.tried + again.tried;
            found = Found { tried, ..again };
        }
    }
    set_variances(problem, &mut found.best, observer);
    Some(found)
}

/// The free answer, repaired, and the best supports on the likelihood linearised about it.
fn starts(
    problem: &Problem,
    free: &Found,
    observer: &mut dyn SearchObserver,
) -> Vec<LinearizationPoint> {
    let at = &free.best.point;
    let Ok(form) = problem.quadratic_form(at, observer) else {
        return Vec::new();
    };
    let constraints = &problem.system.constraints;
    let mut search = ConstrainedForm::new(&form, constraints, &problem.ranges);
    let own = search.repaired(&at.support, free.penalty);
    let proposed = search.proposals(&at.support, Vec::new(), free.penalty, observer);
    let supports = own.map(|s| s.columns).into_iter();
    let supports = supports.chain(proposed.into_iter().map(|(_, s)| s));
    let point = |support: Vec<usize>| {
        let (coefficients, _) = minimum(&form, constraints, &support)?;
        Some(LinearizationPoint {
            support,
            coefficients,
            ..at.clone()
        })
    };
    let points = supports.filter_map(point);
    points.take(1 + SEARCH.carried).collect()
}
