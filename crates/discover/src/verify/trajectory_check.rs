//! An equation that was estimated with its trajectory: does it hold along it, and does the trajectory leave of the readings what is stated?
//!
//! In: the trajectory with all signals, the readings, the equation. Out: figures in 106 bits, and what does not hold. Says nothing of how likely
//! other trajectories or terms are.

use super::double::Double;
use super::rows::Rows;
use super::value::{self, Bounded};
use super::{within, words};
use sidc_data::{Dataset, Samples};
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::discovery::{ChannelFit, Discovery, Equation, Evidence, Together, Verification};

/// Part of a target's size by which its equation may miss along the trajectory: rounding of a rate that was solved for.
const HOLDS: f64 = 1e-9;
/// Difference of what is left of the readings from what is stated, relative.
const STATED: f64 = 1e-6;

/// An equation with its trajectory.
pub struct Path<'a> {
    pub names: &'a Discovery,
    pub equation: &'a Equation,
    pub evidence: &'a Evidence,
    pub together: &'a Together,
    pub samples: &'a Samples,
    pub dataset: &'a Dataset,
}

impl Path<'_> {
    /// `None` if `go_on` ended it.
    pub fn check(&self, out: &mut Verification, go_on: &mut dyn FnMut() -> bool) -> Option<()> {
        out.open.push(words::likelihood());
        out.rows = self.samples.len();
        if out.rows != self.evidence.rows {
            out.fails.push(words::rows(out.rows, self.evidence.rows));
        }
        let off = self.off(go_on)?;
        out.along = Some(off);
        if !within(off, HOLDS) {
            let target = self.names.name(self.equation.target);
            out.fails.push(words::along(&target, off));
        }
        for channel in &self.together.channels {
            self.readings(channel, out);
        }
        Some(())
    }

    /// Root mean square of target less terms along the trajectory, over that of the larger of both.
    fn off(&self, go_on: &mut dyn FnMut() -> bool) -> Option<f64> {
        let used: Vec<usize> = (0..self.samples.len()).collect();
        let weights = vec![1.0; used.len()];
        let rows = Rows::new(self.samples, &used, &weights)?;
        let (mut square, mut size) = (Double::ZERO, 0.0);
        for row in 0..rows.len() {
            if !go_on() {
                return None;
            }
            let at = rows.at(row);
            let mut left = Bounded::exact(at(self.equation.target));
            let mut largest = left.size();
            for found in &self.equation.terms {
                let part = value::term(&found.term, &at).scale(found.coefficient);
                largest = largest.max(part.size());
                left = left.add(part.negative());
            }
            square = square + left.value * left.value;
            size += largest * largest;
        }
        Some((square.value() / size).sqrt())
    }

    /// What the trajectory leaves of one channel.
    fn readings(&self, channel: &ChannelFit, out: &mut Verification) {
        // Readings without weight are not counted in what is stated, and are not listed.
        if channel.left_out > 0 {
            return;
        }
        let found = self.samples.columns.iter();
        let signal = found.map(|c| c.signal);
        let Some(signal) = signal
            .into_iter()
            .find(|s| self.names.name(*s) == channel.signal)
        else {
            out.open.push(words::no_channel(&channel.signal));
            return;
        };
        let left = self.left(signal);
        if !within((left - channel.left).abs(), STATED * left) {
            out.fails
                .push(words::channel(&channel.signal, left, channel.left));
        }
    }

    /// Root mean square of readings less trajectory.
    fn left(&self, signal: Signal) -> f64 {
        let Some(path) = self.samples.column(signal) else {
            return f64::NAN;
        };
        let (mut square, mut count) = (Double::ZERO, 0_usize);
        let rows = self.samples.trajectory.iter().zip(&self.samples.time);
        for ((trajectory, time), x) in rows.zip(&path.values) {
            let Some(record) = self.dataset.trajectories.get(*trajectory as usize) else {
                continue;
            };
            let at = record.time.binary_search_by(|t| t.total_cmp(time)).ok();
            let read = at.zip(record.column(signal)).and_then(|(k, c)| c.get(k));
            if let Some(read) = read.filter(|y| y.is_finite()) {
                let off = Double::sum(*read, -x);
                square = square + off * off;
                count += 1;
            }
        }
        (square.value() / count as f64).sqrt()
    }
}
