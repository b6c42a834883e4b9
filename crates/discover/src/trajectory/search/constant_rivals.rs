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
use crate::trajectory::likelihood::Fit;
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::thresholds::{CONSTANTS, SEARCH};
use sidc_progress::Observer;

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
    range: &dyn Fn(usize, f64) -> (f64, f64),
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
            refits.shorter(own, SEARCH.max_pruned_loss, &mut laws, observer);
            laws.extend(refits.longer(constants, observer));
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
    for law in to_be_fitted(profile, constants, answer) {
        let at = constants.iter().zip(&law.values).enumerate();
        let at = at.map(|(k, (c, value))| {
            let range = range(k, *value);
            let value = value.clamp(range.0, range.1);
            SoughtConstant { value, range, ..*c }
        });
        let at: Vec<SoughtConstant> = at.collect();
        if let Some(fitted) = refits.fitted(&law.terms, &at, observer) {
            refits.shorter(fitted, found.penalty, &mut laws, observer);
        }
        if !observer.go_on() {
            break;
        }
    }
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
            terms(o) == terms(&law) && alike(&o.values, &law.values)
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

fn alike(a: &[f64], b: &[f64]) -> bool {
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= CONSTANTS.same * a.abs().max(b.abs());
    a.iter().zip(b).all(near)
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

    /// The answer with one further term each: those that are predicted to gain most while the constants are free.
    fn longer(
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
        let entering = form.single_changes(&point.support, 0.0, usize::MAX);
        let entering = entering.iter().filter(|m| m.leaves.is_none());
        let columns = entering.filter_map(|m| extended.origin[m.enters?]);
        let longer = columns.take(CONSTANTS.added_terms).filter_map(|column| {
            let mut terms = self.answer.point.active();
            terms.push((column, 0.0));
            terms.sort_unstable_by_key(|(j, _)| *j);
            self.fitted(&terms, constants, observer)
        });
        longer.collect()
    }

    /// Fits of a law without each of the terms whose removal is predicted to cost less than `loss`, and so on from the best of these for as
    /// long as the criterion falls.
    fn shorter(
        &self,
        law: FittedConstants,
        loss: f64,
        out: &mut Vec<FittedConstants>,
        observer: &mut dyn Observer,
    ) {
        let mut here = law;
        loop {
            let ratios = here.terms.iter().zip(&here.variances);
            let ratios = ratios.map(|((_, a), v)| a * a / v).enumerate();
            let mut light: Vec<(usize, f64)> = ratios.filter(|(_, r)| *r < loss).collect();
            light.sort_by(|a, b| a.1.total_cmp(&b.1));
            let mut best: Option<FittedConstants> = None;
            for (place, _) in light {
                let mut rest = here.terms.clone();
                rest.remove(place);
                let next = self.fitted(&rest, &here.constants, observer);
                let Some(next) = next else { continue };
                if best.as_ref().is_none_or(|b| next.value < b.value) {
                    out.extend(best.replace(next));
                } else {
                    out.push(next);
                }
            }
            let value = here.value;
            out.push(here);
            match best {
                Some(b) if b.value < value - SEARCH.min_gain => here = b,
                rest => return out.extend(rest),
            }
        }
    }
}
