//! Which equations have to be solved together.
//!
//! In: a form. Out: the sets of rows whose unknowns tie them to each other or to themselves. Never looks at rows that state
//! their unknown outright: those are solved as they stand.

use crate::discover::Form;

/// Rows that are tied, by their number in the form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    pub rows: Vec<usize>,
    /// True if the block's M and f are free of unknowns.
    pub linear: bool,
}

/// The blocks of the mass matrix that need a solve, in the order of their first row.
pub fn blocks(form: &Form) -> Vec<Block> {
    let mut label: Vec<usize> = (0..form.rows.len()).collect();
    for (i, row) in form.rows.iter().enumerate() {
        for (j, mass) in row.mass.iter().enumerate() {
            if mass.as_number() != Some(0.0) {
                merge(&mut label, i, j);
            }
        }
    }
    let mut firsts: Vec<usize> = label.clone();
    firsts.sort_unstable();
    firsts.dedup();
    let with = |first: usize| -> Vec<usize> {
        (0..label.len())
            .filter(|i| label.get(*i) == Some(&first))
            .collect()
    };
    firsts
        .into_iter()
        .map(with)
        .filter(|rows| rows.len() > 1 || rows.iter().any(|i| !stated_outright(form, *i)))
        .map(|rows| Block {
            linear: rows.iter().all(|i| free(form, *i)),
            rows,
        })
        .collect()
}

/// Both labels become the smaller one.
fn merge(label: &mut [usize], i: usize, j: usize) {
    let (Some(a), Some(b)) = (label.get(i).copied(), label.get(j).copied()) else {
        return;
    };
    for l in label.iter_mut().filter(|l| **l == a.max(b)) {
        *l = a.min(b);
    }
}

fn stated_outright(form: &Form, i: usize) -> bool {
    let own = form.rows.get(i).and_then(|r| r.mass.get(i));
    own.and_then(|m| m.as_number()) == Some(1.0) && free(form, i)
}

fn free(form: &Form, i: usize) -> bool {
    form.rows.get(i).is_some_and(|r| form.free(r))
}
