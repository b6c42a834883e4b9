//! The term that an equation does not have and that comes nearest to earning a place: what may be hidden in the noise.
//!
//! In: products of whole records, a target. Out: the terms that would earn most, what a term costs, and how much longer a record
//! would have to be for one that is really there to be told.

use super::Choice;
use crate::discover::{Discovery, MARKS, Nearest};
use crate::term::{Language, Signal};

/// Terms that are named.
const NAMED: usize = 4;

/// `None` where no term is left to add, or none earns anything.
pub(super) fn nearest(
    choice: &Choice,
    target: Signal,
    names: &Language<Discovery>,
) -> Option<Nearest> {
    let stretches = choice.stretches;
    let own = |p: &usize| stretches.columns.get(*p).is_some_and(|(t, _)| *t == target);
    let all = 0..stretches.columns.len();
    let kept: Vec<usize> = all
        .filter(|p| own(p) || stretches.support.contains(p))
        .collect();
    let form = choice.form(&stretches.whole, &kept);
    let place = |p: &usize| kept.binary_search(p).ok();
    let support: Vec<usize> = stretches.support.iter().filter_map(place).collect();
    let n = stretches.readings;
    // Twice the log likelihood with the noise profiled out.
    let earned = |square: f64| n * (square / n).ln_1p();
    let added = form.moves(&support, 0.0, 8 * kept.len().max(1));
    let mut single: Vec<(usize, f64)> = added
        .iter()
        .filter(|m| m.goes.is_none())
        .filter_map(|m| Some((m.comes?, earned(-m.change))))
        .filter(|(k, _)| kept.get(*k).is_some_and(own))
        .collect();
    single.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let (_, most) = *single.first().filter(|(_, most)| *most > 0.0)?;
    let (costs, _) = stretches.price;
    let near = single.iter().filter(|(_, e)| *e > most - 0.5 * MARKS.tied);
    let name = |k: &usize| {
        let (_, term) = stretches.columns.get(*kept.get(*k)?)?;
        Some(names.term(term))
    };
    Some(Nearest {
        terms: near.filter_map(|(k, _)| name(k)).take(NAMED).collect(),
        earns: most,
        costs,
        longer: ((costs + MARKS.tied) / most).max(1.0),
    })
}
