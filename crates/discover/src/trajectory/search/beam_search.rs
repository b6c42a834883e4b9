//! Best subsets of one law's columns by beam search, the terms of the other laws profiled out.
//!
//! In: a quadratic form, the present support, the columns of a law. Out: for every size the best few supports of that law. Each state of
//! the beam carries the columns orthogonal to its own (Gram–Schmidt on the Gram matrix), so adding one costs one row.

use crate::trajectory::thresholds::SEARCH;
use std::collections::BTreeSet;
use std::ops::Range;

use sidc_solve::{QUADRATIC_FORM, QuadraticForm};

/// A support of one law, columns rising, with the χ² that it leaves together with the other laws' terms.
#[derive(Clone)]
pub(crate) struct Subset {
    pub columns: Vec<usize>,
    pub square: f64,
}

struct BeamState {
    chosen: Vec<usize>,
    /// Products of the law's columns with each orthonormal direction chosen.
    basis: Vec<f64>,
    /// Squared length of each column orthogonal to the chosen ones.
    free: Vec<f64>,
    /// Product of each column with the residual.
    along: Vec<f64>,
    square: f64,
}

/// The best subsets of 0 … `most` of the columns in `range`.
pub(crate) fn best_subsets(
    form: &QuadraticForm,
    support: &[usize],
    range: Range<usize>,
    most: usize,
) -> Vec<Subset> {
    let others: Vec<usize> = support
        .iter()
        .copied()
        .filter(|j| !range.contains(j))
        .collect();
    let n = range.len();
    let mut start = BeamState {
        chosen: Vec::new(),
        basis: Vec::new(),
        free: vec![1.0; n],
        along: form.right[range.clone()].to_vec(),
        square: form.total,
    };
    profile(form, &others, &range, &mut start);
    let mut found = vec![Subset {
        columns: Vec::new(),
        square: start.square,
    }];
    // A column is dependent if little of its length is left after the other laws' terms are projected off.
    let usable: Vec<bool> = start
        .free
        .iter()
        .map(|f| *f > QUADRATIC_FORM.dependent)
        .collect();
    let whole = start.free.clone();
    let rest = LawColumns {
        form,
        range,
        usable,
        whole,
    };
    let mut states = vec![start];
    for size in 1..=most.min(n) {
        states = rest.grow(
            &states,
            if size <= 2 {
                SEARCH.beam_width_pairs
            } else {
                SEARCH.beam_width
            },
        );
        if states.is_empty() {
            break;
        }
        found.extend(states.iter().take(SEARCH.beam_reported).map(|s| Subset {
            columns: s.chosen.iter().map(|j| rest.range.start + j).collect(),
            square: s.square,
        }));
    }
    found
}

/// Projects the other laws' terms off the law's columns and the target.
fn profile(form: &QuadraticForm, others: &[usize], range: &Range<usize>, state: &mut BeamState) {
    let (p, n) = (form.p, range.len());
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut rights: Vec<f64> = Vec::new();
    for s in others {
        let mut row = form.row(*s).to_vec();
        let mut right = form.right[*s];
        for (done, r) in rows.iter().zip(&rights) {
            let along = done[*s];
            (0..p).for_each(|j| row[j] -= along * done[j]);
            right -= along * r;
        }
        let length = row[*s];
        if length <= QUADRATIC_FORM.dependent {
            continue;
        }
        let scale = 1.0 / length.sqrt();
        row.iter_mut().for_each(|x| *x *= scale);
        right *= scale;
        for j in 0..n {
            let x = row[range.start + j];
            state.free[j] -= x * x;
            state.along[j] -= x * right;
        }
        state.square -= right * right;
        state.basis.extend_from_slice(&row[range.clone()]);
        rows.push(row);
        rights.push(right);
    }
}

struct LawColumns<'a> {
    form: &'a QuadraticForm,
    range: Range<usize>,
    usable: Vec<bool>,
    whole: Vec<f64>,
}

impl LawColumns<'_> {
    /// The best supports with one more column.
    fn grow(&self, states: &[BeamState], most: usize) -> Vec<BeamState> {
        let mut moves: Vec<(f64, usize, usize)> = Vec::new();
        for (i, s) in states.iter().enumerate() {
            for j in 0..self.range.len() {
                let able = self.usable[j]
                    && s.free[j]
                        > QUADRATIC_FORM.dependent * self.whole[j].max(QUADRATIC_FORM.dependent);
                if able && !s.chosen.contains(&j) {
                    let gain = (s.along[j] * s.along[j] / s.free[j]).min(s.square.max(0.0));
                    moves.push((s.square - gain, i, j));
                }
            }
        }
        let order = |a: &(f64, usize, usize), b: &(f64, usize, usize)| {
            a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2)))
        };
        // A support of k terms is reached in k ways: more moves are kept than states.
        let kept_moves = 8 * most;
        if moves.len() > kept_moves {
            moves.select_nth_unstable_by(kept_moves, order);
            moves.truncate(kept_moves);
        }
        moves.sort_by(order);
        let mut seen = BTreeSet::new();
        let mut next = Vec::new();
        for (_, i, j) in moves {
            let mut chosen = states[i].chosen.clone();
            chosen.push(j);
            chosen.sort_unstable();
            if seen.insert(chosen.clone()) {
                next.push(self.with_column(&states[i], j, chosen));
            }
            if next.len() == most {
                break;
            }
        }
        next
    }

    fn with_column(&self, s: &BeamState, j: usize, chosen: Vec<usize>) -> BeamState {
        let n = self.range.len();
        let from = self.range.start;
        let mut row = self.form.row(from + j)[self.range.clone()].to_vec();
        for done in s.basis.chunks_exact(n) {
            let along = done[j];
            row.iter_mut().zip(done).for_each(|(x, d)| *x -= along * d);
        }
        let scale = 1.0 / s.free[j].sqrt();
        row.iter_mut().for_each(|x| *x *= scale);
        let right = s.along[j] * scale;
        let (mut free, mut along) = (s.free.clone(), s.along.clone());
        for k in 0..n {
            free[k] -= row[k] * row[k];
            along[k] -= row[k] * right;
        }
        let mut basis = Vec::with_capacity(s.basis.len() + n);
        basis.extend_from_slice(&s.basis);
        basis.extend_from_slice(&row);
        BeamState {
            chosen,
            basis,
            free,
            along,
            square: s.square - right * right,
        }
    }
}
