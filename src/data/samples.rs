//! The rows an equation is found from: all signals at common instants, trajectories one after another.

use crate::term::Signal;

/// A table of M rows; every column is finite.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    /// Trajectory each row came from. Length M.
    pub trajectory: Vec<u32>,
    /// Instant of each row, seconds. Length M.
    pub time: Vec<f64>,
    /// Sorted by signal.
    pub columns: Vec<Column>,
}

#[derive(Clone, Debug)]
pub struct Column {
    pub signal: Signal,
    /// Length M.
    pub values: Vec<f64>,
    pub origin: Origin,
}

#[derive(Clone, Debug)]
pub enum Origin {
    /// `noise` is the standard deviation of the sensor, if it was said.
    Measured { noise: Option<f64> },
    /// Derived by the program; `error` is the estimated standard error of each value (length M), `method` says how in a few words.
    Estimated {
        error: Vec<f64>,
        method: String,
        /// Rows over which errors are much the same, because their windows share samples.
        correlation: f64,
    },
}

impl Samples {
    pub fn len(&self) -> usize {
        self.time.len()
    }

    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    pub fn column(&self, s: Signal) -> Option<&Column> {
        self.columns
            .binary_search_by_key(&s, |c| c.signal)
            .ok()
            .map(|i| &self.columns[i])
    }

    /// The table with only the given rows, in the given order.
    pub fn select(&self, rows: &[usize]) -> Samples {
        let pick = |v: &[f64]| rows.iter().map(|&r| v[r]).collect::<Vec<_>>();
        Samples {
            trajectory: rows.iter().map(|&r| self.trajectory[r]).collect(),
            time: pick(&self.time),
            columns: self
                .columns
                .iter()
                .map(|c| Column {
                    signal: c.signal,
                    values: pick(&c.values),
                    origin: match &c.origin {
                        Origin::Measured { noise } => Origin::Measured { noise: *noise },
                        Origin::Estimated {
                            error,
                            method,
                            correlation,
                        } => Origin::Estimated {
                            error: pick(error),
                            method: method.clone(),
                            correlation: *correlation,
                        },
                    },
                })
                .collect(),
        }
    }
}
