//! Block lower triangular form: the order in which unknowns can be computed, and which of them only together.
//!
//! In: a form. Out: its rows in blocks; a block needs only unknowns of earlier blocks. Works on the structure alone.

use sidc_system::discovery::Form;

/// The strongly connected components of the dependencies between rows, each after those it depends on: rows that reach
/// each other form a block, and a block that reaches more rows comes later.
pub(crate) fn blocks(form: &Form) -> Vec<Vec<usize>> {
    let n = form.rows.len();
    let uses: Vec<Vec<usize>> = form
        .rows
        .iter()
        .enumerate()
        .map(|(i, row)| {
            let entries = row.mass.iter().enumerate();
            let coupled = entries.filter(|(j, m)| *j != i && m.as_number() != Some(0.0));
            coupled.map(|(j, _)| j).collect()
        })
        .collect();
    let reach: Vec<Vec<bool>> = (0..n).map(|i| reached(i, &uses)).collect();
    let reaches = |i: usize, j: usize| reach.get(i).is_some_and(|r| r.get(j) == Some(&true));
    let size = |i: usize| reach.get(i).map_or(0, |r| r.iter().filter(|x| **x).count());
    let mut all: Vec<(usize, Vec<usize>)> = Vec::new();
    for i in 0..n {
        if (0..i).any(|j| reaches(i, j) && reaches(j, i)) {
            continue;
        }
        let block = (i..n).filter(|j| *j == i || reaches(i, *j) && reaches(*j, i));
        all.push((size(i), block.collect()));
    }
    all.sort_by_key(|(size, _)| *size);
    all.into_iter().map(|(_, block)| block).collect()
}

/// Which rows the row `i` depends on, directly or not, itself included.
fn reached(i: usize, uses: &[Vec<usize>]) -> Vec<bool> {
    let mut seen = vec![false; uses.len()];
    let mut open = vec![i];
    while let Some(k) = open.pop() {
        match seen.get_mut(k) {
            Some(mark) if !*mark => *mark = true,
            _ => continue,
        }
        open.extend(uses.get(k).into_iter().flatten());
    }
    seen
}
