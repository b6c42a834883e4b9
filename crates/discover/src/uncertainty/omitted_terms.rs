//! The omitted terms that come nearest to being selected: effects that the noise may hide.
//!
//! In: the regression of one target. Out: the terms of largest gain, the price of a term, and how much longer a record would have to
//! be to select one of them if it is real.

use super::target_regression::TargetRegression;
use super::thresholds::OMITTED_TERMS;
use sidc_lang::term::{Language, Signal};
use sidc_system::discovery::{Discovery, MARKS, OmittedTerm};

/// `None` if there is no omitted term, or none improves the fit.
pub(super) fn nearest_omitted_terms(
    regression: &TargetRegression,
    target: Signal,
    names: &Language<Discovery>,
) -> Option<OmittedTerm> {
    let of_target = |k: usize| regression.column(k).is_some_and(|(t, _)| *t == target);
    let moves = OMITTED_TERMS.moves * regression.columns.len();
    let moves = regression
        .form
        .single_changes(&regression.support, 0.0, moves);
    let mut gains: Vec<(usize, f64)> = moves
        .iter()
        .filter(|m| m.leaves.is_none())
        .filter_map(|m| Some((m.enters?, regression.likelihood_ratio(-m.change))))
        .filter(|(k, _)| of_target(*k))
        .collect();
    gains.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let (_, largest) = *gains.first().filter(|(_, largest)| *largest > 0.0)?;
    let (costs, _) = regression.blocks.price;
    let similar = OMITTED_TERMS.similar * MARKS.tied;
    let similar = gains.iter().filter(|(_, gain)| *gain > largest - similar);
    let name = |k: &usize| Some(names.term(&regression.column(*k)?.1));
    Some(OmittedTerm {
        terms: similar
            .filter_map(|(k, _)| name(k))
            .take(OMITTED_TERMS.named)
            .collect(),
        earns: largest,
        costs,
        longer: ((costs + MARKS.tied) / largest).max(1.0),
    })
}
