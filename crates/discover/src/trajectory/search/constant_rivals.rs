//! Laws beside an answer, each with the unknown constants fitted to it.
//!
//! In: a problem, what a search found at some values of the constants. Out: laws with their likeliest constants. Chooses none.
//!
//! A search looks at one value of each constant. There a further term makes up for the error of the constant, and a law that lacks the term with
//! the constant is compared with one at the wrong value. Among the laws here are the answer without each of its terms, and the best with each
//! constant, wherever that lies in its range.

use super::constant_profile::{ProfiledLaw, ProfiledLaws, profiled_laws};
use super::support_search::Found;
use super::unknown_constants::{
    FittedConstants, SoughtConstant, fit_constants, fit_constants_at, with_columns,
    with_constant_values, with_sensitivities,
};
use crate::statistics::agree;
use crate::trajectory::likelihood::Fit;
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::thresholds::{CONSTANTS, SEARCH};
use sidc_progress::Observer;
use sidc_solve::{SingleChange, threads};

/// What a search found.
#[derive(Clone, Copy)]
pub struct Answer<'a> {
    pub problem: &'a Problem,
    pub found: &'a Found,
    /// Whether the answer leaves no more than the noise of the sensors. If it leaves more, only laws that may be better are of interest.
    pub explained: bool,
}

/// Laws with their likeliest constants, the best first: the answer itself if it holds a constant; the answer with one term less or more;
/// the best laws of the profile at `points`, also without their weak terms. `range` gives the range of a constant about a value.
pub fn laws_with_constants(
    answer: &Answer,
    constants: &[SoughtConstant],
    points: &[Vec<f64>],
    range: &(dyn Fn(usize, f64) -> (f64, f64) + Sync),
    observer: &mut dyn Observer,
) -> Vec<FittedConstants> {
    let Answer { problem, found, .. } = *answer;
    let refits = Refits {
        problem,
        answer: &found.best,
        inefficiency: found.inefficiency,
    };
    let mut laws: Vec<FittedConstants> = Vec::new();
    let own = fit_constants(
        problem,
        &found.best,
        constants,
        found.inefficiency,
        observer,
    );
    match own {
        Some(own) if answer.explained => {
            laws.extend(refits.without_each(own, SEARCH.max_pruned_loss, observer));
            laws.extend(refits.changed(constants, observer));
        }
        own => laws.extend(own),
    }
    let profile = profiled_laws(
        problem,
        &found.best,
        (constants, points),
        found.penalty,
        observer,
    );
    let profiled = to_be_fitted(profile, constants, answer);
    let fitted = |law: ProfiledLaw, observer: &mut dyn Observer| {
        let at = constants.iter().zip(&law.values).enumerate();
        let at = at.map(|(k, (c, value))| {
            let range = range(k, *value);
            let value = value.clamp(range.0, range.1);
            SoughtConstant { value, range, ..*c }
        });
        let at: Vec<SoughtConstant> = at.collect();
        let fitted = refits.fitted(&law.terms, &at, observer);
        fitted.map(|law| refits.pruned(law, found.penalty, observer))
    };
    let fitted = threads::map_watched(threads::available(), profiled, observer, fitted);
    laws.extend(fitted.into_iter().flatten().flatten());
    laws.sort_by(|a, b| a.value.total_cmp(&b.value));
    laws
}

/// The laws of a profile that are worth a fit, no two alike: those predicted to be near the answer or better, up to a number, and the best
/// law with each constant that the answer lacks.
fn to_be_fitted(
    profile: ProfiledLaws,
    constants: &[SoughtConstant],
    answer: &Answer,
) -> Vec<ProfiledLaw> {
    let columns = &answer.problem.system.columns;
    let lacking = |c: &SoughtConstant| {
        let mut own = answer.found.best.support().iter();
        !own.any(|j| columns[*j].mentions(c.signal))
    };
    let mut lacking: Vec<&SoughtConstant> = constants.iter().filter(|c| lacking(c)).collect();
    let loss = match answer.explained {
        true => CONSTANTS.profiled_loss,
        false => 0.0,
    };
    let mut out: Vec<ProfiledLaw> = Vec::new();
    for law in profile.laws {
        let fills = |c: &&SoughtConstant| columns[law.holding].mentions(c.signal);
        let wanted = lacking.iter().any(fills);
        let near = law.predicted < profile.answer + loss;
        let same = |o: &ProfiledLaw| {
            let terms = |l: &ProfiledLaw| -> Vec<usize> { l.terms.iter().map(|t| t.0).collect() };
            terms(o) == terms(&law) && agree(&o.values, &law.values, CONSTANTS.same)
        };
        let room = out.len() < CONSTANTS.profiled_laws;
        if !(wanted || room && near) || out.iter().any(same) {
            continue;
        }
        lacking.retain(|c| !fills(c));
        out.push(law);
    }
    out
}

/// Fits that start from the trajectory of an answer.
struct Refits<'a> {
    problem: &'a Problem,
    answer: &'a Fit,
    inefficiency: f64,
}

impl Refits<'_> {
    fn fitted(
        &self,
        terms: &[(usize, f64)],
        constants: &[SoughtConstant],
        observer: &mut dyn Observer,
    ) -> Option<FittedConstants> {
        let (support, coefficients) = terms.iter().copied().unzip();
        let point = LinearizationPoint {
            support,
            coefficients,
            ..self.answer.point.clone()
        };
        let at = with_constant_values(self.problem, constants);
        fit_constants_at(&at, point, constants, self.inefficiency, observer)
    }

    /// The answer with one further term each, and with one term in place of another: those that are predicted to describe the readings best
    /// while the constants are free.
    fn changed(
        &self,
        constants: &[SoughtConstant],
        observer: &mut dyn Observer,
    ) -> Vec<FittedConstants> {
        let sensitive = with_sensitivities(self.problem, self.answer, constants);
        let Some((extended, new, _)) = sensitive else {
            return Vec::new();
        };
        let point = with_columns(extended.point(&self.answer.point), &new);
        let Ok(form) = extended.problem.quadratic_form(&point, observer) else {
            return Vec::new();
        };
        let terms = |change: &SingleChange| {
            let entering = extended.origin[change.enters?]?;
            let leaving = match change.leaves {
                // The column of a constant stays.
                Some(j) => Some(extended.origin[j]?),
                None => None,
            };
            let kept = self.answer.point.active().into_iter();
            let kept = kept.filter(|(j, _)| Some(*j) != leaving);
            let mut terms: Vec<(usize, f64)> = kept.chain([(entering, 0.0)]).collect();
            terms.sort_unstable_by_key(|(j, _)| *j);
            Some(terms)
        };
        let changes = form.single_changes(&point.support, 0.0, usize::MAX);
        let near = changes
            .iter()
            .filter(|c| c.change < CONSTANTS.profiled_loss);
        let (exchanges, additions): (Vec<&SingleChange>, Vec<&SingleChange>) =
            near.partition(|c| c.leaves.is_some());
        let best = |all: Vec<&SingleChange>| {
            let all = all.into_iter().filter_map(terms);
            all.take(CONSTANTS.added_terms).collect::<Vec<_>>()
        };
        let changed = [best(additions), best(exchanges)].concat();
        let fitted = |terms: Vec<(usize, f64)>, observer: &mut dyn Observer| {
            self.fitted(&terms, constants, observer)
        };
        let fitted = threads::map_watched(threads::available(), changed, observer, fitted);
        fitted.into_iter().flatten().collect()
    }

    /// The law, and without each of the terms whose removal is predicted to cost less than `loss`. The best of these is pruned if it is better
    /// than the law.
    fn without_each(
        &self,
        law: FittedConstants,
        loss: f64,
        observer: &mut dyn Observer,
    ) -> Vec<FittedConstants> {
        let light = light_terms(&law, loss);
        let shorter = light
            .into_iter()
            .filter_map(|place| self.without(&law, place, observer));
        let mut laws: Vec<FittedConstants> = shorter.collect();
        laws.sort_by(|a, b| a.value.total_cmp(&b.value));
        if laws.first().is_some_and(|best| best.improves(&law)) {
            let best = laws.remove(0);
            laws.extend(self.pruned(best, loss, observer));
        }
        laws.push(law);
        laws
    }

    /// Backward elimination: of the terms whose removal is predicted to cost less than `loss`, cheapest first, the first removal that lowers the
    /// criterion is kept; then again. Returns every law that was fitted.
    fn pruned(
        &self,
        law: FittedConstants,
        loss: f64,
        observer: &mut dyn Observer,
    ) -> Vec<FittedConstants> {
        let mut passed = Vec::new();
        let mut here = law;
        loop {
            let mut better = None;
            for place in light_terms(&here, loss) {
                match self.without(&here, place, observer) {
                    Some(next) if next.improves(&here) => {
                        better = Some(next);
                        break;
                    }
                    next => passed.extend(next),
                }
            }
            let Some(better) = better else {
                passed.push(here);
                return passed;
            };
            passed.push(std::mem::replace(&mut here, better));
        }
    }

    fn without(
        &self,
        law: &FittedConstants,
        place: usize,
        observer: &mut dyn Observer,
    ) -> Option<FittedConstants> {
        let mut rest = law.terms.clone();
        rest.remove(place);
        self.fitted(&rest, &law.constants, observer)
    }
}

impl FittedConstants {
    fn improves(&self, other: &FittedConstants) -> bool {
        self.value < other.value - SEARCH.min_gain
    }
}

/// Places of the terms whose removal is predicted to cost less than `loss`, the cheapest first.
fn light_terms(law: &FittedConstants, loss: f64) -> Vec<usize> {
    let ratios = law.terms.iter().zip(&law.variances);
    let ratios = ratios.map(|((_, a), v)| a * a / v).enumerate();
    let mut light: Vec<(usize, f64)> = ratios.filter(|(_, r)| *r < loss).collect();
    light.sort_by(|a, b| a.1.total_cmp(&b.1));
    light.into_iter().map(|(place, _)| place).collect()
}
