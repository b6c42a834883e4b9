//! Best subsets of one law's columns by beam search, the terms of the other laws profiled out.
//!
//! In: the quadratic form, the present support, a law. Out: for every size the best few supports of that law. Each state of the
//! beam carries the columns projected off its own, so a step costs one row.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::solve::quadratic::{DEPENDENT, Quadratic};

/// States kept at each size, and of pairs.
const BEAM: usize = 200;
const PAIRS: usize = 500;
/// Supports reported of each size.
const REPORTED: usize = 8;

/// A support of one law, columns rising, and the χ² that is left with it and the others' terms.
#[derive(Clone)]
pub(super) struct Subset {
    pub columns: Vec<usize>,
    pub square: f64,
}

struct State {
    chosen: Vec<usize>,
    /// Orthonormal directions chosen, as rows over the law's columns.
    basis: Vec<f64>,
    /// Squared length of each column off the chosen.
    free: Vec<f64>,
    /// Its product with what is left of the target.
    along: Vec<f64>,
    square: f64,
}

/// The best subsets of sizes 0 … `most` of the columns in `range`.
pub(super) fn subsets(
    form: &Quadratic,
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
    let mut start = State {
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
    // What is left of a column once the others' terms are off it: dependent is measured against that.
    let usable: Vec<bool> = start.free.iter().map(|f| *f > DEPENDENT).collect();
    let whole = start.free.clone();
    let rest = Rest {
        form,
        range,
        usable,
        whole,
    };
    let mut states = vec![start];
    for size in 1..=most.min(n) {
        states = rest.grow(&states, if size <= 2 { PAIRS } else { BEAM });
        if states.is_empty() {
            break;
        }
        found.extend(states.iter().take(REPORTED).map(|s| Subset {
            columns: s.chosen.iter().map(|j| rest.range.start + j).collect(),
            square: s.square,
        }));
    }
    found
}

/// Takes the others' terms off the law's columns and the target.
fn profile(form: &Quadratic, others: &[usize], range: &Range<usize>, state: &mut State) {
    let (p, n) = (form.p, range.len());
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut rights: Vec<f64> = Vec::new();
    for s in others {
        // Gram–Schmidt on the Gram matrix: each row is a direction's product with all columns.
        let mut row = form.row(*s).to_vec();
        let mut right = form.right[*s];
        for (done, r) in rows.iter().zip(&rights) {
            let along = done[*s];
            (0..p).for_each(|j| row[j] -= along * done[j]);
            right -= along * r;
        }
        let length = row[*s];
        if length <= DEPENDENT {
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

struct Rest<'a> {
    form: &'a Quadratic,
    range: Range<usize>,
    usable: Vec<bool>,
    whole: Vec<f64>,
}

impl Rest<'_> {
    /// The best supports with one more column.
    fn grow(&self, states: &[State], most: usize) -> Vec<State> {
        let mut moves: Vec<(f64, usize, usize)> = Vec::new();
        for (i, s) in states.iter().enumerate() {
            for j in 0..self.range.len() {
                let able = self.usable[j] && s.free[j] > DEPENDENT * self.whole[j].max(DEPENDENT);
                if able && !s.chosen.contains(&j) {
                    let gain = (s.along[j] * s.along[j] / s.free[j]).min(s.square.max(0.0));
                    moves.push((s.square - gain, i, j));
                }
            }
        }
        let order = |a: &(f64, usize, usize), b: &(f64, usize, usize)| {
            a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2)))
        };
        // The same support is reached on as many ways as it has terms.
        let enough = 8 * most;
        if moves.len() > enough {
            moves.select_nth_unstable_by(enough, order);
            moves.truncate(enough);
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

    fn with_column(&self, s: &State, j: usize, chosen: Vec<usize>) -> State {
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
        State {
            chosen,
            basis,
            free,
            along,
            square: s.square - right * right,
        }
    }
}
