//! A trajectory that still knows its table: what binding and the checks of the record share.

use super::{Table, Trajectory};

/// One trajectory and the rows it came from.
pub(super) struct Piece<'a> {
    pub table: &'a Table,
    /// Rows of the table, one for each instant.
    pub rows: Vec<usize>,
    pub trajectory: Trajectory,
}
