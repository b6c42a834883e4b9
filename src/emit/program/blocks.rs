//! In which order the unknowns can be had, and which of them only together.
//!
//! In: a system. Out: its rows in blocks; a block needs the unknowns of blocks before it only. Never looks at values.

use crate::discover::Form;

/// Rows whose unknowns depend on each other, each block after those it needs. Strongly connected components: rows that
/// reach each other are one block, and who reaches more rows comes later.
pub(super) fn blocks(form: &Form) -> Vec<Vec<usize>> {
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

/// The rows that row `i` needs, itself included, and those that these need.
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
