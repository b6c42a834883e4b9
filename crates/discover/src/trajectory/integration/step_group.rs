//! Intervals of a block that take the same number of steps, so that they can be integrated side by side.
//!
//! In: a record, places in a block, a number of steps. Out: where each interval starts and how long its steps are.

use crate::trajectory::model::Record;

/// Intervals of a record that take the same number of steps.
pub(crate) struct StepGroup<'a> {
    pub record: &'a Record,
    /// The samples at which they start.
    pub intervals: Vec<usize>,
    /// Their places in the block.
    pub slots: Vec<usize>,
    /// Length of a step in each, seconds.
    pub h: Vec<f64>,
    pub steps: usize,
    /// Which part of the intervals is integrated, from 0 to 1.
    pub within: (f64, f64),
    /// Switches that slide meanwhile.
    pub sliding: Vec<usize>,
}

impl<'a> StepGroup<'a> {
    pub fn new(record: &'a Record, first: usize, slots: Vec<usize>, steps: usize) -> Self {
        let intervals: Vec<usize> = slots.iter().map(|b| first + b).collect();
        let length = |k: &usize| (record.time[k + 1] - record.time[*k]) / steps as f64;
        StepGroup {
            record,
            h: intervals.iter().map(length).collect(),
            intervals,
            slots,
            steps,
            within: (0.0, 1.0),
            sliding: Vec::new(),
        }
    }

    /// One step over a part of a single interval.
    pub fn of_one(record: &'a Record, (interval, slot): (usize, usize)) -> Self {
        StepGroup {
            record,
            h: vec![0.0],
            intervals: vec![interval],
            slots: vec![slot],
            steps: 1,
            within: (0.0, 0.0),
            sliding: Vec::new(),
        }
    }

    /// Moves a single step to another part of its interval.
    pub fn set_within(&mut self, from: f64, to: f64) {
        let k = self.intervals[0];
        self.within = (from, to);
        self.h[0] = (to - from) * (self.record.time[k + 1] - self.record.time[k]);
    }

    pub fn count(&self) -> usize {
        self.h.len()
    }

    /// Position in the interval (0 to 1) of a point within step `s` (0 to 1).
    pub fn part(&self, s: usize, part: f64) -> f64 {
        let (from, to) = self.within;
        from + (to - from) * (s as f64 + part) / self.steps as f64
    }
}
