//! Trajectories as they were measured.

use crate::term::Signal;

/// All trajectories of one run, in the order of files, then of appearance.
#[derive(Clone, Debug, Default)]
pub struct Dataset {
    pub trajectories: Vec<Trajectory>,
}

/// One uninterrupted record.
#[derive(Clone, Debug, Default)]
pub struct Trajectory {
    /// File name without folders, and the run's id if one file holds several.
    pub name: String,
    /// Seconds, strictly rising; sample numbers in discrete time. Length M.
    pub time: Vec<f64>,
    /// Measured signals in model units, each of length M; NaN marks a missing value. Sorted by signal.
    pub columns: Vec<(Signal, Vec<f64>)>,
}

impl Trajectory {
    pub fn len(&self) -> usize {
        self.time.len()
    }

    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    pub fn column(&self, s: Signal) -> Option<&[f64]> {
        self.columns
            .iter()
            .find(|(c, _)| *c == s)
            .map(|(_, v)| v.as_slice())
    }
}
