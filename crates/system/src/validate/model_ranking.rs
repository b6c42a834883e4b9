//! Candidate models in order: the best, and the Pareto front of error against size.
//!
//! In: for each candidate its error on data not used, and its number of terms. Out: their order, the front, the best. After Figures 2.1 and 2.2 of the thesis.

use crate::validate::thresholds::RANKING;

/// What a candidate is ranked by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Merit {
    /// Error to signal of the free run on data not used, in decibels; infinite if the run ended early or there is
    /// none.
    pub error: f64,
    /// Terms found in all equations.
    pub terms: usize,
}

/// Candidates by their index.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranking {
    /// Smallest error first; of equal errors the smaller model.
    pub order: Vec<usize>,
    /// No other has both fewer terms and a smaller error.
    pub front: Vec<bool>,
    /// The smallest model whose error equals the smallest; `None` if no candidate could be run.
    pub best: Option<usize>,
}

/// Ranks candidates; equal ones keep their order.
pub fn rank(all: &[Merit]) -> Ranking {
    let error = |i: usize| all[i].error.max(RANKING.floor);
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|&a, &b| {
        let errors = error(a).total_cmp(&error(b));
        errors.then(all[a].terms.cmp(&all[b].terms))
    });
    let least = order.first().map_or(f64::INFINITY, |&i| error(i));
    let equal = |i: &&usize| least.is_finite() && error(**i) <= least + RANKING.equal;
    let best = order.iter().filter(equal).min_by_key(|&&i| all[i].terms);
    let beats = |a: usize, b: usize| {
        let (less, fewer) = (error(a) <= error(b), all[a].terms <= all[b].terms);
        less && fewer && (error(a) < error(b) || all[a].terms < all[b].terms)
    };
    let front = |b: usize| error(b) < f64::INFINITY && !(0..all.len()).any(|a| beats(a, b));
    Ranking {
        front: (0..all.len()).map(front).collect(),
        best: best.copied(),
        order,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn merits(all: &[(f64, usize)]) -> Vec<Merit> {
        let merit = |&(error, terms)| Merit { error, terms };
        all.iter().map(merit).collect()
    }

    #[test]
    fn the_smaller_of_two_equal_ones_is_best() {
        let ranking = rank(&merits(&[(-40.3, 9), (-40.0, 4), (-12.0, 2), (-20.0, 6)]));
        assert_eq!(ranking.order, [0, 1, 3, 2]);
        assert_eq!(ranking.front, [true, true, true, false]);
        assert_eq!(ranking.best, Some(1));
    }

    #[test]
    fn errors_of_rounding_are_equal() {
        let ranking = rank(&merits(&[(-210.0, 12), (-180.0, 7)]));
        assert_eq!((ranking.order, ranking.best), (vec![1, 0], Some(1)));
        assert_eq!(ranking.front, [false, true]);
    }

    #[test]
    fn what_cannot_be_run_is_last_and_never_best() {
        let ranking = rank(&merits(&[(f64::INFINITY, 1), (3.0, 5)]));
        assert_eq!((ranking.order, ranking.best), (vec![1, 0], Some(1)));
        assert_eq!(ranking.front, [false, true]);
        assert_eq!(rank(&merits(&[(f64::INFINITY, 1)])).best, None);
        assert_eq!(rank(&[]).best, None);
    }
}
