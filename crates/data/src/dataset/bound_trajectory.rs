//! A trajectory that still knows its table, so that findings can name file and row.
//!
//! Made by `binding`, read by `checks`, then dropped.

use super::trajectories::Trajectory;
use crate::csv::Table;

/// One trajectory and the rows it came from.
pub(crate) struct BoundTrajectory<'a> {
    pub table: &'a Table,
    /// Rows of the table, one for each instant.
    pub rows: Vec<usize>,
    pub trajectory: Trajectory,
}

impl BoundTrajectory<'_> {
    /// The table's row of instant `i`, as messages name it.
    pub(crate) fn place(&self, i: usize) -> String {
        self.table.place(self.rows.get(i).copied().unwrap_or(0))
    }
}
