//! Searches over subsets that every selection of terms here shares: one step of a beam, and descent by single changes.
//!
//! In: a problem that scores subsets and lists their neighbours. Out: larger subsets, or the subset that no single change
//! improves. Never fits anything itself.

use sidc_progress::Observer;
use std::collections::BTreeSet;

use crate::selection::thresholds::SUBSET_SEARCH;

/// A selection of columns by a criterion, as a local search sees it.
pub(crate) trait SubsetProblem {
    /// A subset that was scored.
    type Subset;

    /// The criterion of a subset; smaller is better.
    fn criterion(&self, subset: &Self::Subset) -> f64;

    /// Subsets one drop, addition or swap away, in a fixed order. Ends early, with those it has, when the observer says so.
    fn neighbours(
        &mut self,
        subset: &Self::Subset,
        observer: &mut dyn Observer,
    ) -> Vec<Self::Subset>;
}

/// Steepest descent: moves to the best neighbour until none improves the criterion, at most `max_moves` times. What it passes is
/// the problem's to remember.
pub(crate) fn descend<P: SubsetProblem>(
    problem: &mut P,
    start: P::Subset,
    max_moves: usize,
    observer: &mut dyn Observer,
) {
    let mut best = start;
    for _ in 0..max_moves {
        let before = problem.criterion(&best);
        for neighbour in problem.neighbours(&best, observer) {
            // The first of equals.
            if problem.criterion(&neighbour) < problem.criterion(&best) {
                best = neighbour;
            }
        }
        let least_gain = SUBSET_SEARCH.least_gain * before.abs();
        if problem.criterion(&best) >= before - least_gain {
            return;
        }
    }
}

/// One step of a beam search: at most `width` distinct subsets with one more column.
///
/// `additions` are (rank, place of the parent, column), best first; `support` gives the sorted columns of a parent; `extend` makes
/// the new state of a parent, a column and the sorted new support.
pub(crate) fn extend_beam<'s, S>(
    additions: &[(f64, usize, usize)],
    width: usize,
    support: impl Fn(usize) -> &'s [usize],
    mut extend: impl FnMut(usize, usize, &[usize]) -> S,
) -> Vec<S> {
    let mut seen = BTreeSet::new();
    let mut next = Vec::new();
    for (_, parent, column) in additions {
        // A subset is reached in as many ways as it has terms.
        let mut larger = support(*parent).to_vec();
        larger.push(*column);
        larger.sort_unstable();
        if !seen.contains(&larger) {
            next.push(extend(*parent, *column, &larger));
            seen.insert(larger);
        }
        if next.len() == width {
            break;
        }
    }
    next
}
