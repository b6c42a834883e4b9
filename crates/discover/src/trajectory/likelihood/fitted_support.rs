//! A fitted support, and what both ways to fit one ask of it.
//!
//! In: a point. Out: a [`Fit`], or whether the point has left the data. Takes no steps.

use super::step_halving::StepHalving;
use crate::trajectory::model::{LinearizationPoint, Problem, ProcessNoise};
use crate::trajectory::thresholds::GAUSS_NEWTON;

/// A fitted support.
#[derive(Clone, Debug)]
pub struct Fit {
    pub(crate) point: LinearizationPoint,
    /// Variances of the coefficients; 0 for those that constraints fix.
    pub variances: Vec<f64>,
    /// The criterion: smaller is better.
    pub value: f64,
    /// Sum of squared residuals of each sensor's readings, each over its relative noise and whitened; groups × states.
    pub residual_squares: Vec<f64>,
    /// χ² of the slips between the laws and the trajectory, in units of the criterion.
    pub law_misfit: f64,
    /// Whether the fit converged.
    pub converged: bool,
}

impl Fit {
    pub fn support(&self) -> &[usize] {
        &self.point.support
    }

    pub fn coefficients(&self) -> &[f64] {
        &self.point.coefficients
    }

    /// What moves the states besides the laws, if that was fitted.
    pub fn process(&self) -> Option<&ProcessNoise> {
        self.point.process.as_ref()
    }

    /// Noise of each sensor, groups × states.
    pub fn sigma(&self) -> &[f64] {
        &self.point.sigma
    }

    /// States along each record, samples × n.
    pub fn paths(&self) -> &[Vec<f64>] {
        &self.point.paths
    }

    /// Reading less trajectory, over the relative noise of the reading, at every sample of a record; NaN where there is no reading.
    pub(crate) fn residuals<'a>(
        &'a self,
        problem: &'a Problem,
        record: usize,
        state: usize,
    ) -> impl Iterator<Item = f64> + use<'a> {
        let path = self.point.paths[record].iter();
        let estimated = path.skip(state).step_by(problem.states());
        let record = &problem.records[record];
        let read = record.measured[state].iter().enumerate();
        read.zip(estimated)
            .map(move |((k, y), z)| (y - z) / record.relative_noise_at(state, k))
    }

    /// These residuals whitened for the noise's memory that the problem assumes; unchanged where it assumes white noise.
    pub(crate) fn whitened(&self, problem: &Problem, record: usize, state: usize) -> Vec<f64> {
        let left: Vec<f64> = self.residuals(problem, record, state).collect();
        problem.records[record].whitened(state, &left)
    }
}

/// The best fit judged so far, for use when every shorter step from it leaves the data.
pub(super) fn best_judged(halving: StepHalving<Fit>) -> Option<Fit> {
    let (fit, converged) = halving.best(false)?;
    fit.value.is_finite().then_some(Fit { converged, ..fit })
}

/// Whether a fit whose criterion lags that far behind another is unlikely to catch up in the steps left, each of which may gain what the
/// last one did.
pub(crate) fn is_hopeless(lag: f64, left: usize, gain: f64) -> bool {
    lag > GAUSS_NEWTON.hopeless_lag + GAUSS_NEWTON.hopeless_gain * left as f64 * gain
}

/// Whether some state is so far from its readings, or from the smoothed trajectory where it has none, that the fit is of no use.
pub(super) fn left_the_data(problem: &Problem, point: &LinearizationPoint) -> bool {
    let n = problem.states();
    let records = problem
        .records
        .iter()
        .zip(&problem.smoothed)
        .zip(&point.paths);
    for (r, ((record, curve), path)) in records.enumerate() {
        let sigma = &point.sigma[problem.sensors.of(r)];
        let relative = sigma.iter().zip(&problem.spread).enumerate();
        let relative = relative.map(|(i, (s, d))| record.relative_noise_range(i).1 * s / d);
        let limit =
            GAUSS_NEWTON.lost_spread + GAUSS_NEWTON.lost_noise * relative.fold(0.0, f64::max);
        for (at, x) in path.iter().enumerate() {
            let (k, i) = (at / n, at % n);
            if problem.system.is_hidden(i) {
                // A hidden state has no readings to compare with, so its first guess is used. Negated so that NaN counts as lost.
                let near =
                    (x - curve.states[at]).abs() <= GAUSS_NEWTON.lost_hidden * problem.spread[i];
                if !near {
                    return true;
                }
                continue;
            }
            let read = record.measured[i][k];
            let (from, limit) = match read.is_finite() {
                true => (read, limit),
                false => (curve.states[at], GAUSS_NEWTON.lost_unread.max(limit)),
            };
            // Negated so that NaN counts as lost.
            let near = (x - from).abs() <= limit * problem.spread[i];
            if !near {
                return true;
            }
        }
    }
    false
}
