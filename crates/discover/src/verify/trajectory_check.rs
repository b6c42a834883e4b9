//! An equation that was estimated with its trajectory: does it hold along the trajectory, and are the residuals of the readings those stated?
//!
//! In: the trajectory with all signals, the readings, the equation. Out: figures in 106 bits, and claims that do not hold. Says nothing
//! about how likely other trajectories or terms are.

use super::ball::Ball;
use super::double_double::DoubleDouble;
use super::equation_check::Case;
use super::messages;
use super::term_evaluation;
use super::thresholds::VERIFICATION;
use super::tolerance::within;
use super::weighted_sums::WeightedRows;
use sidc_data::Samples;
use sidc_lang::term::{Signal, SignalNames};
use sidc_progress::Observer;
use sidc_system::discovery::{ChannelFit, Evidence, JointEvidence, Verification};

/// An equation with its trajectory.
pub struct TrajectoryCheck<'a> {
    pub case: &'a Case<'a>,
    pub evidence: &'a Evidence,
    pub together: &'a JointEvidence,
    pub samples: &'a Samples,
}

impl TrajectoryCheck<'_> {
    /// `None` if the observer ended it.
    pub fn run(&self, out: &mut Verification, observer: &mut dyn Observer) -> Option<()> {
        out.open.push(messages::likelihood());
        out.rows = self.samples.len();
        if out.rows != self.evidence.rows {
            out.fails.push(messages::rows(out.rows, self.evidence.rows));
        }
        let miss = self.equation_residual(observer)?;
        out.along = Some(miss);
        if !within(miss, VERIFICATION.trajectory) {
            let target = self.case.names.name(self.case.equation.target);
            out.fails.push(messages::along(&target, miss));
        }
        for channel in &self.together.channels {
            self.compare_channel(channel, out);
        }
        Some(())
    }

    /// Root mean square of target minus terms along the trajectory, over that of the largest of them in each row.
    fn equation_residual(&self, observer: &mut dyn Observer) -> Option<f64> {
        let used: Vec<usize> = (0..self.samples.len()).collect();
        let weights = vec![1.0; used.len()];
        let rows = WeightedRows::new(self.samples, &used, &weights)?;
        let (mut square, mut size) = (DoubleDouble::ZERO, 0.0);
        for row in 0..rows.len() {
            if !observer.go_on() {
                return None;
            }
            let at = rows.at(row);
            let mut residual = Ball::exact(at(self.case.equation.target));
            let mut largest = residual.size();
            for found in &self.case.equation.terms {
                let part = term_evaluation::term(&found.term, &at).scale(found.coefficient);
                largest = largest.max(part.size());
                residual = residual.add(part.negative());
            }
            square = square + residual.value * residual.value;
            size += largest * largest;
        }
        Some((square.to_f64() / size).sqrt())
    }

    /// Compares the residual of one channel with the one stated.
    fn compare_channel(&self, channel: &ChannelFit, out: &mut Verification) {
        // The stated residual leaves out readings without weight, and which these are is not stated.
        if channel.left_out > 0 {
            return;
        }
        let found = self.samples.columns.iter();
        let signal = found.map(|c| c.signal);
        let Some(signal) = signal
            .into_iter()
            .find(|s| self.case.names.name(*s) == channel.signal)
        else {
            out.open.push(messages::no_channel(&channel.signal));
            return;
        };
        let residual = self.reading_residual(signal);
        if !within(
            (residual - channel.residual).abs(),
            VERIFICATION.readings * residual,
        ) {
            out.fails.push(messages::channel(
                &channel.signal,
                residual,
                channel.residual,
            ));
        }
    }

    /// The row whose reading is of an instant: later by the delay of the sensor, to the rounding of its sum.
    fn row(&self, time: &[f64], at: f64, signal: Signal) -> Option<usize> {
        let late = self.case.names.sensor_delay(signal.var);
        if late == 0.0 {
            return time.binary_search_by(|t| t.total_cmp(&at)).ok();
        }
        let read = at + late;
        let step = (time.last()? - time.first()?) / time.len() as f64;
        let tolerance = VERIFICATION.instant * step;
        let row = time.partition_point(|t| *t < read - tolerance);
        Some(row).filter(|k| time.get(*k).is_some_and(|t| *t <= read + tolerance))
    }

    /// Root mean square of readings minus trajectory.
    fn reading_residual(&self, signal: Signal) -> f64 {
        let Some(trajectory) = self.samples.column(signal) else {
            return f64::NAN;
        };
        let (mut square, mut count) = (DoubleDouble::ZERO, 0_usize);
        let rows = self.samples.trajectory.iter().zip(&self.samples.time);
        for ((record, time), x) in rows.zip(&trajectory.values) {
            let Some(readings) = self.case.dataset.trajectories.get(*record as usize) else {
                continue;
            };
            let at = self.row(&readings.time, *time, signal);
            let read = at.zip(readings.column(signal)).and_then(|(k, c)| c.get(k));
            if let Some(read) = read.filter(|y| y.is_finite()) {
                let residual = DoubleDouble::sum(*read, -x);
                square = square + residual * residual;
                count += 1;
            }
        }
        (square.to_f64() / count as f64).sqrt()
    }
}
