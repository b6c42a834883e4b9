//! From the proposal of a solver to the terms that are kept.
//!
//! In: a dictionary, a target, coefficients that a solver proposes. Out: the subset of best criterion and those that tie with it.
//! Never estimates coefficients.

use crate::selection::thresholds::TERM_SELECTION;
use nalgebra::DMatrix;
use sidc_progress::{Activity, Observer};

use crate::selection::best_subset::{BestSubsetSearch, ScoredSubset};
use crate::selection::information_criterion::InformationCriterion;
use crate::selection::qr_reduction::qr_reduction;
use sidc_solve::dictionary::Dictionary;

/// The selected terms, and the supports that tie with them.
#[derive(Clone, Debug, Default)]
pub struct TermSelection {
    /// Columns of the dictionary, rising.
    pub support: Vec<usize>,
    /// Its criterion.
    pub value: f64,
    /// Supports of the same size within [`TERM_SELECTION.tie`].
    pub ties: Vec<Vec<usize>>,
    /// Candidates that took part.
    pub searched: usize,
    /// True if the support is exactly what the solver proposed.
    pub as_proposed: bool,
    /// True if the search was interrupted.
    pub cut: bool,
}

/// Selects among all candidates, or among the proposals of the solver if there are too many, as long as the observer allows. Every
/// selection has the columns that are required, which rise.
pub fn select_terms(
    dictionary: &dyn Dictionary,
    target: &[f64],
    coefficients: &[(usize, f64)],
    (criterion, required): (InformationCriterion, &[usize]),
    observer: &mut dyn Observer,
) -> TermSelection {
    let proposed = proposed_columns(dictionary, coefficients);
    let mut pool = candidate_pool(dictionary, &proposed);
    pool.extend_from_slice(required);
    pool.sort_unstable();
    pool.dedup();
    let start: Vec<usize> = proposed
        .iter()
        .take(TERM_SELECTION.max_terms)
        .filter_map(|j| pool.binary_search(j).ok())
        .collect();
    let most = TERM_SELECTION
        .max_terms
        .min(dictionary.rows().saturating_sub(1))
        .max(1);
    let mut cut = false;
    let mut observer = |activity: Activity| {
        let answer = observer.hear(activity);
        cut = answer.is_break();
        answer
    };
    let search = best_subset_search(dictionary, target, &pool, (criterion, required));
    let found = search.run(most, &[start], &mut observer);
    let named = |s: &ScoredSubset| -> Vec<usize> { s.support.iter().map(|i| pool[*i]).collect() };
    let Some(best) = found.first() else {
        return TermSelection {
            support: Vec::new(),
            value: f64::INFINITY,
            ties: Vec::new(),
            searched: pool.len(),
            as_proposed: proposed.is_empty(),
            cut,
        };
    };
    let ties = found
        .iter()
        .skip(1)
        .filter(|s| {
            s.support.len() == best.support.len() && s.value < best.value + TERM_SELECTION.tie
        })
        .map(&named)
        .collect();
    let support = named(best);
    let mut own = proposed;
    own.sort_unstable();
    TermSelection {
        as_proposed: own == support,
        support,
        value: best.value,
        ties,
        searched: pool.len(),
        cut,
    }
}

/// The columns that take part, rising: all, or the first proposals if there are too many.
pub fn candidate_pool(dictionary: &dyn Dictionary, proposed: &[usize]) -> Vec<usize> {
    if dictionary.cols() <= TERM_SELECTION.exhaustive_columns {
        return (0..dictionary.cols()).collect();
    }
    let mut first: Vec<usize> = proposed
        .iter()
        .copied()
        .take(TERM_SELECTION.max_proposals)
        .collect();
    first.sort_unstable();
    first
}

/// Columns whose share |a|‖φ‖ is above rounding, largest first.
pub fn proposed_columns(dictionary: &dyn Dictionary, coefficients: &[(usize, f64)]) -> Vec<usize> {
    let sizes: Vec<(usize, f64)> = coefficients
        .iter()
        .map(|(j, a)| (*j, a.abs() * dictionary.norm(*j)))
        .collect();
    let largest = sizes.iter().fold(0.0, |m: f64, (_, s)| m.max(*s));
    let mut found: Vec<(usize, f64)> = sizes
        .into_iter()
        .filter(|(_, s)| *s > TERM_SELECTION.negligible_share * largest)
        .collect();
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found.into_iter().map(|(j, _)| j).collect()
}

/// The search on the columns of `pool`, reduced by QR to at most as many rows as columns.
pub fn best_subset_search(
    dictionary: &dyn Dictionary,
    target: &[f64],
    pool: &[usize],
    (criterion, required): (InformationCriterion, &[usize]),
) -> BestSubsetSearch {
    let (m, n) = (dictionary.rows(), pool.len());
    let mut columns = vec![0.0; m * n];
    for (out, &j) in columns.chunks_exact_mut(m).zip(pool) {
        dictionary.column(j, out);
        let norm = dictionary.norm(j);
        if norm > 0.0 {
            out.iter_mut().for_each(|x| *x /= norm);
        }
    }
    columns.extend_from_slice(target);
    let (reduced, outside) = qr_reduction(DMatrix::from_vec(m, n + 1, columns));
    let rows = reduced.nrows();
    let (columns, target) = reduced.as_slice().split_at(rows * n);
    let places = required.iter().filter_map(|j| pool.binary_search(j).ok());
    BestSubsetSearch::new(rows, columns.to_vec(), target.to_vec(), outside, criterion)
        .requiring(places.collect())
}
