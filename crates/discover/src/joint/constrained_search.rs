//! The search under the constraints of a model. A search without them comes first, since its answer mostly satisfies them.
//!
//! In: a problem with its constraints. Out: the answer that satisfies them, and the free answer where that breaks one. A free answer
//! that satisfies all constraints is returned unchanged, to the last digit. Never writes messages.

use std::borrow::Cow;

use crate::joint::delay_outlier_search::{search_from, search_system};
use crate::joint::joint_fit::{JointFit, unexplained};
use crate::joint::pooled_search::search_runs;
use crate::options::Options;
use crate::trajectory::{CoefficientConstraints, Problem, Rival, RunNotFollowed, StartingSupport};
use sidc_lang::model::Model;
use sidc_progress::{EquationObserver, Observer};

/// The answer under the constraints.
pub(crate) struct ConstrainedAnswer<'a> {
    pub fit: JointFit<'a>,
    /// The free answer, where it breaks a constraint.
    pub free: Option<JointFit<'a>>,
    /// Runs that were left out of the estimate, because the laws do not follow them.
    pub not_followed: Vec<RunNotFollowed>,
}

/// What a search under constraints ended with.
pub(crate) enum SearchOutcome<'a> {
    Answer(Box<ConstrainedAnswer<'a>>),
    /// No laws could be fitted under the constraints, but some were without them.
    OnlyFree(Box<JointFit<'a>>),
    Nothing,
}

impl SearchOutcome<'_> {
    /// The same, owning its problems.
    pub fn into_owned<'b>(self) -> SearchOutcome<'b> {
        match self {
            SearchOutcome::Answer(answer) => SearchOutcome::Answer(Box::new(ConstrainedAnswer {
                fit: answer.fit.into_owned(),
                free: answer.free.map(JointFit::into_owned),
                not_followed: answer.not_followed,
            })),
            SearchOutcome::OnlyFree(free) => SearchOutcome::OnlyFree(Box::new(free.into_owned())),
            SearchOutcome::Nothing => SearchOutcome::Nothing,
        }
    }
}

/// Searches all equations from `start`. If the search is stopped before there is an answer under the constraints, the free answer is
/// given.
pub(crate) fn search_under_constraints<'a>(
    (model, problem): (&Model, &'a Problem),
    start: Option<StartingSupport>,
    options: &Options,
    watcher: &mut EquationObserver,
) -> SearchOutcome<'a> {
    let settled = |fit, free, not_followed| {
        SearchOutcome::Answer(Box::new(ConstrainedAnswer {
            fit,
            free,
            not_followed,
        }))
    };
    let answer = |fit, free| settled(fit, free, Vec::new());
    let constraints = &problem.system.constraints;
    if constraints.rows.is_empty() {
        let found = search_runs((model, problem), start, options, watcher);
        return found.map_or(SearchOutcome::Nothing, |pooled| {
            settled(pooled.fit, None, pooled.not_followed)
        });
    }
    let unconstrained = problem.under(constraints.without_rows());
    let found = search_system((model, &unconstrained), start, options, watcher);
    let free = found.map(|fit| owned(fit, constraints));
    let obeys = |fit: &JointFit| {
        let best = &fit.found.best;
        constraints.hold(best.support(), best.coefficients())
    };
    if let Some(mut free) = free {
        if watcher.stop().is_some() {
            return answer(free, None);
        }
        if obeys(&free) {
            drop_broken_rivals(&mut free, watcher);
            return answer(free, None);
        }
        return match under_constraints(model, problem, (options, &free), watcher) {
            Some(fit) => answer(fit, Some(free)),
            None if watcher.stop().is_some() => answer(free, None),
            None => SearchOutcome::OnlyFree(Box::new(free)),
        };
    }
    match watcher.stop() {
        // The free search found nothing; the constraints may keep the search from going astray.
        None => search_system((model, problem), None, options, watcher)
            .map_or(SearchOutcome::Nothing, |fit| answer(fit, None)),
        Some(_) => SearchOutcome::Nothing,
    }
}

/// The better of two searches under the constraints. The first continues from the free answer, with its delays and without its
/// outliers. Where it leaves more than noise and the free answer does not, the second starts afresh.
fn under_constraints<'a>(
    model: &Model,
    problem: &'a Problem,
    (options, free): (&Options, &JointFit<'a>),
    watcher: &mut EquationObserver,
) -> Option<JointFit<'a>> {
    let near = search_from(free, watcher);
    let poor = |f: &JointFit| unexplained(&f.problem, &f.found.best);
    let enough = |f: &JointFit| !poor(f) || poor(free);
    if near.as_ref().is_some_and(enough) || watcher.stop().is_some() {
        return near;
    }
    let anew = search_system((model, problem), None, options, watcher);
    let (Some(a), Some(b)) = (&near, &anew) else {
        return anew.or(near);
    };
    let better = match poor(b) {
        false => true,
        // Likelihoods are comparable only if both fits are of the same readings.
        true => likelihoods_comparable(a, b) && a.misfit() > b.misfit(),
    };
    if better { anew } else { near }
}

/// Whether two fits have the same delays and as many readings left out, so that their likelihoods are comparable.
pub(crate) fn likelihoods_comparable(a: &JointFit, b: &JointFit) -> bool {
    a.late == b.late && a.problem.left_out.len() == b.problem.left_out.len()
}

/// A free fit, owning its problem, to which the constraints are restored for what follows.
fn owned<'a>(fit: JointFit, constraints: &CoefficientConstraints) -> JointFit<'a> {
    JointFit {
        problem: Cow::Owned(fit.problem.under(constraints.clone())),
        found: fit.found,
        late: fit.late,
        lag: fit.lag,
        offset: fit.offset,
        white_noise_answer: (fit.white_noise_answer)
            .map(|white| Box::new(owned(*white, constraints))),
    }
}

/// Removes rivals that break the constraints, judged by the likelihood linearised about the answer.
fn drop_broken_rivals(fit: &mut JointFit, observer: &mut dyn Observer) {
    let best = &fit.found.best;
    let Ok(form) = fit.problem.quadratic_form(&best.point, observer) else {
        return;
    };
    let own = best.support().to_vec();
    let constraints = &fit.problem.system.constraints;
    fit.found.rivals.retain(|Rival { support, .. }| {
        *support == own || constraints.hold(support, &form.least_squares(support).coefficients)
    });
}
