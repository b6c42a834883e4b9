//! What becomes of an equation that has to do without one of its terms.
//!
//! In: products of whole records, the term. Out: the terms that step in, those no longer needed, and what that costs.

use super::identical::identical;
use super::{Part, worth};
use sidc_lang::term::{Language, Term};
use sidc_system::discovery::{Discovery, Without};

/// The best support without the column at `place` that single changes lead to; the other equations keep their terms. `whole` has
/// the columns of the equation, the barred one among them.
pub(super) fn without(whole: &Part, place: usize, names: &Language<Discovery>) -> Option<Without> {
    let stretches = whole.stretches;
    let (target, barred) = stretches.columns.get(place)?;
    let rest = Part::of(stretches, *target, Some(place));
    let (price, _) = stretches.price;
    let end = rest.form.steepest_descent(&rest.support, price);
    let more =
        rest.form.least_squares(&end).square - whole.form.least_squares(&whole.support).square;
    let terms = end.len() as f64 - whole.support.len() as f64;
    let outside = |of: &[usize], other: &[usize]| -> Vec<Term> {
        let only = of.iter().filter(|k| !other.contains(k));
        only.filter_map(|k| Some(rest.column(*k)?.1.clone()))
            .collect()
    };
    let (enter, leave) = (outside(&end, &rest.support), outside(&rest.support, &end));
    let named = |all: &[Term]| all.iter().map(|t| names.term(t)).collect();
    Some(Without {
        same: leave.is_empty() && identical(barred, &enter),
        enter: named(&enter),
        leave: named(&leave),
        cost: worth(more.max(0.0), stretches.readings) + price * terms,
    })
}
