//! Laws beyond the libraries: whether terms that these lack describe the readings better.
//!
//! In: a problem, what was found, more terms for each law. Out: laws with some of these terms and how much better they are, or
//! nothing. The same criterion and the same refits decide as in the search.

use super::noise_floor_search::NoiseFloorSearch;
use super::support_search::Found;
use crate::trajectory::likelihood::PenalizedLikelihood;
use crate::trajectory::model::Problem;
use crate::trajectory::residuals::{Channel, channels};
use crate::trajectory::thresholds::SEARCH;
use sidc_lang::term::Term;
use sidc_progress::Observer;

/// Better laws with terms that the libraries lack.
#[derive(Clone, Debug)]
pub struct BetterLaws {
    /// For each law.
    pub changes: Vec<LawChange>,
    /// Gain of the criterion, in units of independent readings.
    pub gain: f64,
    /// What they leave of each state that is read.
    pub channels: Vec<Channel>,
}

/// How the terms of one law change.
#[derive(Clone, Debug)]
pub struct LawChange {
    pub enter: Vec<Term>,
    pub leave: Vec<Term>,
    /// Entering terms that the library lacks.
    pub lacking: Vec<Term>,
}

/// Searches from the laws found, with `extra[l]` as further candidates of law l. Laws with fewer terms need only improve the
/// criterion, others by `margin` in units of independent readings, and more the more candidates there are: of N wrong laws the best has a
/// likelihood N times as large by chance (Bonferroni). `None` if no such laws are found.
pub fn search_beyond_libraries(
    problem: &Problem,
    found: &Found,
    extra: &[Vec<Term>],
    margin: f64,
    observer: &mut dyn Observer,
) -> Option<BetterLaws> {
    let extended = problem.with_extra_columns(extra);
    let lowest = SEARCH.floors[SEARCH.floors.len() - 1];
    let more = &extended.problem;
    let criterion = PenalizedLikelihood::at_floor(more, lowest, found.inefficiency);
    let mut level = NoiseFloorSearch::new(more, criterion);
    let start = extended.point(&found.best.point);
    level.fit([start.clone()], observer);
    let before = level.best.first()?.value;
    let candidates: usize = extra.iter().map(Vec::len).sum();
    let margin = (margin + 2.0 * (candidates.max(1) as f64).ln()) * found.inefficiency;
    level.improve_briefly(observer);
    let best = level.best.first()?;
    let gain = before - best.value;
    let fewer = best.support().len() < start.support.len();
    if gain < margin && !(fewer && gain > 0.0) {
        return None;
    }
    let difference = |from: &[usize], to: &[usize], l: usize| -> Vec<usize> {
        let own = &more.system.laws[l].columns;
        let only = to.iter().filter(|j| own.contains(j) && !from.contains(j));
        only.copied().collect()
    };
    let terms = |columns: &[usize]| -> Vec<Term> {
        let all = columns.iter().map(|j| more.term(*j).clone());
        all.collect()
    };
    let change = |l: usize| {
        let enter = difference(&start.support, best.support(), l);
        let new = enter.iter().filter(|j| extended.origin[**j].is_none());
        LawChange {
            lacking: terms(&new.copied().collect::<Vec<_>>()),
            enter: terms(&enter),
            leave: terms(&difference(best.support(), &start.support, l)),
        }
    };
    Some(BetterLaws {
        changes: (0..more.system.laws.len()).map(change).collect(),
        gain: gain / found.inefficiency,
        channels: channels(more, best),
    })
}
