//! Which equations have to be solved together: the connected components of the mass matrix as a graph.
//!
//! In: a form. Out: sets of rows coupled through their unknowns. Rows that state their unknown explicitly are left
//! out.

use crate::discovery::Form;

/// Coupled rows, by their index in the form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    pub rows: Vec<usize>,
    /// True if the block's M and f are free of unknowns.
    pub linear: bool,
}

/// The components that need a solve, in the order of their first row.
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

/// Gives both components the smaller label.
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
