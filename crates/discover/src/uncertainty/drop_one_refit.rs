//! The best equation without one of its terms.
//!
//! In: the regression of an equation, the column of the term. Out: the terms that replace it, those no longer needed, and the loss.

use super::target_regression::TargetRegression;
use super::term_identity::is_identity;
use sidc_lang::term::{Language, Term};
use sidc_system::discovery::{Discovery, DropOneRefit};

/// The best support without column `dropped` that single changes reach. The other equations keep their terms. `full` is the
/// regression with the column.
pub(super) fn drop_one_refit(
    full: &TargetRegression,
    dropped: usize,
    names: &Language<Discovery>,
) -> Option<DropOneRefit> {
    let blocks = full.blocks;
    let (target, term) = blocks.columns.get(dropped)?;
    let reduced = TargetRegression::new(blocks, *target, Some(dropped));
    let (price, _) = blocks.price;
    let refit = reduced.form.steepest_descent(&reduced.support, price);
    let more =
        reduced.form.least_squares(&refit).square - full.form.least_squares(&full.support).square;
    let terms = refit.len() as f64 - full.support.len() as f64;
    let difference = |of: &[usize], other: &[usize]| -> Vec<Term> {
        let only = of.iter().filter(|k| !other.contains(k));
        only.filter_map(|k| Some(reduced.column(*k)?.1.clone()))
            .collect()
    };
    let enter = difference(&refit, &reduced.support);
    let leave = difference(&reduced.support, &refit);
    let refit_terms: Vec<Term> = (refit.iter())
        .filter_map(|k| Some(reduced.column(*k)?.1.clone()))
        .collect();
    let named = |all: &[Term]| all.iter().map(|t| names.term(t)).collect();
    Some(DropOneRefit {
        same: leave.is_empty() && is_identity(term, &refit_terms, names.0),
        enter: named(&enter),
        leave: named(&leave),
        cost: full.likelihood_ratio(more.max(0.0)) + price * terms,
    })
}
