//! The term that an equation does not have and that comes nearest to earning a place: what may be hidden in the noise.
//!
//! In: products of whole records, a target. Out: the terms that would earn most, what a term costs, and how much longer a record
//! would have to be for one that is really there to be told.

use super::{Part, worth};
use sidc_lang::term::{Language, Signal};
use sidc_system::discovery::{Discovery, MARKS, Nearest};

/// Terms that are named.
const NAMED: usize = 4;

/// `None` where no term is left to add, or none earns anything.
pub(super) fn nearest(part: &Part, target: Signal, names: &Language<Discovery>) -> Option<Nearest> {
    let stretches = part.stretches;
    let own = |k: usize| part.column(k).is_some_and(|(t, _)| *t == target);
    let added = part
        .form
        .single_changes(&part.support, 0.0, 8 * part.kept.len());
    let mut single: Vec<(usize, f64)> = added
        .iter()
        .filter(|m| m.leaves.is_none())
        .filter_map(|m| Some((m.enters?, worth(-m.change, stretches.readings))))
        .filter(|(k, _)| own(*k))
        .collect();
    single.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let (_, most) = *single.first().filter(|(_, most)| *most > 0.0)?;
    let (costs, _) = stretches.price;
    let near = single.iter().filter(|(_, e)| *e > most - 0.5 * MARKS.tied);
    let name = |k: &usize| Some(names.term(&part.column(*k)?.1));
    Some(Nearest {
        terms: near.filter_map(|(k, _)| name(k)).take(NAMED).collect(),
        earns: most,
        costs,
        longer: ((costs + MARKS.tied) / most).max(1.0),
    })
}
