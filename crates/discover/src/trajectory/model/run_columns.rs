//! Which columns belong to one run only. The columns of one term enter and leave a support together, so all runs share one.
//!
//! In: columns, each with its term and run. Out: groups of them, and supports that contain each group whole. Sees no data.

use std::collections::BTreeMap;

use sidc_lang::term::Term;

/// Which columns of a problem belong to one run only.
#[derive(Clone, Debug, Default)]
pub struct RunColumns(BTreeMap<usize, RunColumn>);

/// A column of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunColumn {
    /// The term without its run.
    pub term: Term,
    pub trajectory: usize,
    /// Columns of one term have the same number.
    pub(crate) group: usize,
}

impl RunColumns {
    pub(crate) fn new(columns: BTreeMap<usize, RunColumn>) -> RunColumns {
        RunColumns(columns)
    }

    pub fn get(&self, column: usize) -> Option<&RunColumn> {
        self.0.get(&column)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// All columns of the term that a column belongs to, itself included; `None` if it is no column of a run.
    pub fn group_of(&self, column: usize) -> Option<Vec<usize>> {
        let group = self.get(column)?.group;
        let own = self.0.iter().filter(|(_, c)| c.group == group);
        Some(own.map(|(j, _)| *j).collect())
    }

    /// The proposed support with all columns of a term, one for each run, or none of them. A term that is new to the support enters
    /// for all runs; a term of which the proposal keeps half of its columns or fewer leaves.
    pub(crate) fn whole(&self, mut proposed: Vec<usize>, current: &[usize]) -> Vec<usize> {
        if self.is_empty() {
            return proposed;
        }
        let groups: Vec<Vec<usize>> = proposed.iter().filter_map(|j| self.group_of(*j)).collect();
        for group in groups {
            let kept = group.iter().filter(|j| proposed.contains(j)).count();
            let enters = !current.contains(&group[0]);
            proposed.retain(|j| !group.contains(j));
            if enters || 2 * kept > group.len() {
                proposed.extend(group);
            }
        }
        proposed.sort_unstable();
        proposed
    }

    /// The same after columns were renumbered: column j was `origin[j]` before.
    pub(crate) fn moved(&self, origin: &[Option<usize>]) -> RunColumns {
        let new = origin.iter().enumerate();
        let kept = new.filter_map(|(j, from)| Some((j, self.get((*from)?)?.clone())));
        RunColumns(kept.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns 1, 2, 3 are one term in three runs.
    fn three_runs() -> RunColumns {
        let column = |trajectory| RunColumn {
            term: Term::one(),
            trajectory,
            group: 9,
        };
        RunColumns((0..3).map(|t| (1 + t, column(t))).collect())
    }

    #[test]
    fn the_columns_of_a_term_enter_and_leave_together() {
        let runs = three_runs();
        assert_eq!(runs.whole(vec![0, 2], &[0]), [0, 1, 2, 3]);
        assert_eq!(runs.whole(vec![0, 2], &[0, 1, 2, 3]), [0]);
        assert_eq!(runs.whole(vec![0, 2, 3], &[0, 1, 2, 3]), [0, 1, 2, 3]);
        assert_eq!(runs.whole(vec![0, 4], &[0]), [0, 4]);
        assert_eq!(runs.group_of(2), Some(vec![1, 2, 3]));
        assert_eq!(runs.group_of(0), None);
    }

    #[test]
    fn columns_that_move_keep_their_run() {
        let moved = three_runs().moved(&[None, Some(0), Some(3), Some(1)]);
        assert_eq!(moved.get(2).map(|c| c.trajectory), Some(2));
        assert_eq!(moved.get(1), None);
        assert_eq!(moved.group_of(3), Some(vec![2, 3]));
    }
}
