//! From a solver's proposal to the terms that are kept.

use faer::Mat;
use faer::linalg::solvers::Qr;

use super::subset::{Criterion, Search, Subset};
use crate::dictionary::Dictionary;

/// Up to so many candidates, all of them take part in the choice; beyond, only those that the solver proposed.
pub const SEARCHABLE: usize = 400;
/// Most proposals that take part.
const PROPOSALS: usize = 80;
/// Most terms of one equation.
pub const MOST_TERMS: usize = 40;
/// Part of the largest contribution under which a coefficient is the solver's rounding.
const NEGLIGIBLE: f64 = 1e-7;
/// Difference of the criterion under which two supports of equal size are a tie (Kass & Raftery 1995: 6 is "strong").
pub const TIE: f64 = 6.0;

/// The terms kept, and what else would do as well.
pub struct Choice {
    /// Columns of the dictionary, rising.
    pub support: Vec<usize>,
    /// Supports of the same size within [`TIE`].
    pub ties: Vec<Vec<usize>>,
    /// Candidates that the choice was among.
    pub searched: usize,
    /// True if the support is the solver's own, not a part of it or another.
    pub as_proposed: bool,
    /// True if the search was ended before it was through.
    pub cut: bool,
}

/// Chooses among subsets of the candidates (all, or the solver's proposals if there are too many), as long as `go_on` allows.
pub fn choose(
    dictionary: &dyn Dictionary,
    target: &[f64],
    coefficients: &[(usize, f64)],
    criterion: Criterion,
    go_on: &mut dyn FnMut() -> bool,
) -> Choice {
    let proposed = proposals(dictionary, coefficients);
    let pool = pool(dictionary, &proposed);
    let start: Vec<usize> = proposed
        .iter()
        .take(MOST_TERMS)
        .filter_map(|j| pool.binary_search(j).ok())
        .collect();
    let most = MOST_TERMS.min(dictionary.rows().saturating_sub(1)).max(1);
    let mut cut = false;
    let found = search(dictionary, target, &pool, criterion).run(most, &[start], &mut || {
        cut = !go_on();
        !cut
    });
    let named = |s: &Subset| -> Vec<usize> { s.support.iter().map(|i| pool[*i]).collect() };
    let Some(best) = found.first() else {
        return Choice {
            support: Vec::new(),
            ties: Vec::new(),
            searched: pool.len(),
            as_proposed: proposed.is_empty(),
            cut,
        };
    };
    let ties = found
        .iter()
        .skip(1)
        .filter(|s| s.support.len() == best.support.len() && s.value < best.value + TIE)
        .map(&named)
        .collect();
    let support = named(best);
    let mut own = proposed;
    own.sort_unstable();
    Choice {
        as_proposed: own == support,
        support,
        ties,
        searched: pool.len(),
        cut,
    }
}

/// The columns that take part in a choice, rising: all, or the first proposals if there are too many.
pub fn pool(dictionary: &dyn Dictionary, proposed: &[usize]) -> Vec<usize> {
    if dictionary.cols() <= SEARCHABLE {
        return (0..dictionary.cols()).collect();
    }
    let mut first: Vec<usize> = proposed.iter().copied().take(PROPOSALS).collect();
    first.sort_unstable();
    first
}

/// Columns with a contribution above rounding, largest first.
pub fn proposals(dictionary: &dyn Dictionary, coefficients: &[(usize, f64)]) -> Vec<usize> {
    let norms = dictionary.norms();
    let sizes = coefficients.iter().map(|(j, a)| (*j, a.abs() * norms[*j]));
    let largest = sizes.clone().fold(0.0, |m: f64, (_, s)| m.max(s));
    let mut found: Vec<(usize, f64)> = sizes.filter(|(_, s)| *s > NEGLIGIBLE * largest).collect();
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found.into_iter().map(|(j, _)| j).collect()
}

/// The pool's columns, rotated to at most as many rows as columns.
pub fn search(
    dictionary: &dyn Dictionary,
    target: &[f64],
    pool: &[usize],
    criterion: Criterion,
) -> Search {
    let (m, n) = (dictionary.rows(), pool.len());
    let mut columns = vec![0.0; m * n];
    for (out, &j) in columns.chunks_exact_mut(m).zip(pool) {
        dictionary.column(j, out);
        let norm = dictionary.norms()[j];
        if norm > 0.0 {
            out.iter_mut().for_each(|x| *x /= norm);
        }
    }
    if m <= n + 1 {
        return Search::new(m, columns, target.to_vec(), 0.0, criterion);
    }
    let all = Mat::from_fn(
        m,
        n + 1,
        |i, j| {
            if j < n { columns[j * m + i] } else { target[i] }
        },
    );
    let qr = Qr::new(all.as_ref());
    let r = qr.thin_R();
    let rotated = (0..n)
        .flat_map(|j| (0..n).map(move |i| if i <= j { r[(i, j)] } else { 0.0 }))
        .collect();
    let aim = (0..n).map(|i| r[(i, n)]).collect();
    Search::new(n, rotated, aim, r[(n, n)].powi(2), criterion)
}
