//! What becomes of an equation that has to do without one of its terms.
//!
//! In: products of whole records, the term. Out: the terms that step in, those no longer needed, and what that costs.

use super::Choice;
use super::identical::identical;
use crate::discover::{Discovery, Without};
use crate::term::{Language, Term};

/// The best support without the column at `place` that single changes lead to; the other equations keep their terms.
pub(super) fn without(
    choice: &Choice,
    place: usize,
    names: &Language<Discovery>,
) -> Option<Without> {
    let stretches = choice.stretches;
    let (target, barred) = stretches.columns.get(place)?;
    let own = |p: &usize| stretches.columns.get(*p).is_some_and(|(t, _)| t == target);
    let kept: Vec<usize> = (0..stretches.columns.len())
        .filter(|p| *p != place && (own(p) || stretches.support.contains(p)))
        .collect();
    let form = choice.form(&stretches.whole, &kept);
    let at = |p: &usize| kept.binary_search(p).ok();
    let start: Vec<usize> = stretches.support.iter().filter_map(at).collect();
    let (price, _) = stretches.price;
    let end = form.improve(&start, price);
    let all: Vec<usize> = (0..stretches.columns.len()).collect();
    let before = choice
        .form(&stretches.whole, &all)
        .least(&stretches.support);
    let more = (form.least(&end).square - before.square).max(0.0);
    let terms = end.len() as f64 - stretches.support.len() as f64;
    // Twice the log likelihood with the noise profiled out, which counts independent readings.
    let cost = stretches.readings * (more / stretches.readings).ln_1p() + price * terms;
    let term = |k: &usize| Some(&stretches.columns.get(*kept.get(*k)?)?.1);
    let name = |k: &usize| term(k).map(|t| names.term(t));
    let entered: Vec<Term> = (end.iter().filter(|k| !start.contains(k)))
        .filter_map(|k| term(k).cloned())
        .collect();
    Some(Without {
        same: start.iter().all(|k| end.contains(k)) && identical(barred, &entered),
        enter: end
            .iter()
            .filter(|k| !start.contains(k))
            .filter_map(name)
            .collect(),
        leave: start
            .iter()
            .filter(|k| !end.contains(k))
            .filter_map(name)
            .collect(),
        cost,
    })
}
