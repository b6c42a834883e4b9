//! The rows of a simulated trajectory.
//!
//! In: state, unknowns, outputs and inputs, row after row. Out: the same by column. Knows no equations.

use crate::simulate::fault::Fault;

/// What was simulated, row after row, up to a fault.
#[derive(Clone, Debug, Default)]
pub(crate) struct Path {
    /// State, unknowns, outputs.
    pub rows: Rows,
    /// Inputs, in the order of the form.
    pub inputs: Rows,
    pub fault: Option<Fault>,
    pub evaluations: u64,
    pub stiff_from: Option<f64>,
}

/// Rows of equal width in one allocation.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    values: Vec<f64>,
    count: usize,
}

impl Rows {
    /// Reserves room for so many values.
    pub fn reserve(&mut self, values: usize) {
        self.values.reserve_exact(values);
    }

    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        self.values.extend(row);
        self.count += 1;
    }

    pub fn len(&self) -> usize {
        self.count
    }

    /// One row; `None` behind the last.
    pub fn row(&self, k: usize) -> Option<&[f64]> {
        let width = self.values.len() / self.count.max(1);
        self.values.get(k * width..(k + 1) * width)
    }

    /// The values of one column.
    pub fn column(&self, place: usize) -> impl Iterator<Item = &f64> {
        let width = self.values.len() / self.count.max(1);
        self.values.iter().skip(place).step_by(width.max(1))
    }
}
