//! One signal along one trajectory: measured, shifted, or differentiated from its highest measured derivative.
//!
//! In: a trajectory and what the estimates of all its signals share. Out: values with the standard errors of what was
//! estimated. No estimate crosses a gap; one crosses a jump of an input only where that promises half the error.

use sidc_lang::model::Model;
use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::{Signal, SignalNames};
use sidc_progress::Observer;

use super::thresholds::SAMPLING;
use crate::dataset::{Dataset, Trajectory};
use crate::derivatives::{self, Estimate, Stopped};
use crate::segmentation::{Break, breaks_at, segments};
use crate::time_axis::TimeGrid;
use crate::{intersample, time_axis};

/// One signal along one trajectory; NaN where it is unknown.
pub(super) struct SignalValues {
    pub values: Vec<f64>,
    /// `None` if measured.
    pub estimated: Option<EstimateInfo>,
}

/// How an estimate was made, and how good it is.
pub(super) struct EstimateInfo {
    pub error: Vec<f64>,
    pub method: String,
    pub correlation: f64,
}

/// Counts rows between jumps of an input that are too close together to differentiate within.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct JumpCrossings {
    pub crossed: usize,
    pub rows: usize,
}

/// A trajectory with what the estimates of all its signals share.
pub(super) struct SignalEstimator<'a> {
    model: &'a Model,
    trajectory: &'a Trajectory,
    grid: TimeGrid,
    gaps: Vec<Break>,
    gaps_and_jumps: Vec<Break>,
    has_jumps: bool,
    intersample: intersample::IntersampleError,
}

impl<'a> SignalEstimator<'a> {
    pub(super) fn new(model: &'a Model, dataset: &Dataset, trajectory: &'a Trajectory) -> Self {
        let gaps = time_axis::gaps(&trajectory.time);
        let jumps = intersample::jumps(&dataset.inputs, trajectory);
        SignalEstimator {
            model,
            trajectory,
            grid: TimeGrid::new(&trajectory.time),
            gaps: breaks_at(&gaps, &[], 1),
            has_jumps: !jumps.is_empty(),
            gaps_and_jumps: breaks_at(&gaps, &jumps, 1),
            intersample: intersample::intersample_error(&dataset.inputs, trajectory),
        }
    }

    /// The signal, or `None` if it is neither measured nor derivable.
    pub(super) fn signal(
        &self,
        s: Signal,
        crossings: &mut JumpCrossings,
        observer: &mut dyn Observer,
    ) -> Result<Option<SignalValues>, Stopped> {
        let measured = |values: Vec<f64>| SignalValues {
            values,
            estimated: None,
        };
        if s.shift != 0 {
            let unshifted = self.measured(Signal { shift: 0, ..s });
            return Ok(unshifted.map(|values| measured(self.shifted(&values, s.shift))));
        }
        if let Some(values) = self.measured(s) {
            return Ok(Some(measured(values)));
        }
        let mut lower = (0..s.der).rev().map(|der| Signal { der, ..s });
        let below = lower.find_map(|b| Some((b, self.trajectory.column(b)?)));
        match below {
            Some((below, values)) if s.der - below.der <= SAMPLING.max_differentiations => {
                let order = (s.der - below.der) as usize;
                let estimate = self.derivative(values, below, order, crossings, observer)?;
                Ok(Some(estimate))
            }
            _ => Ok(None),
        }
    }

    fn measured(&self, s: Signal) -> Option<Vec<f64>> {
        match self.trajectory.column(s) {
            Some(values) => Some(values.to_vec()),
            None => (s == Signal::TIME).then(|| self.trajectory.time.clone()),
        }
    }

    /// At each row the value of the sample whose number is `by` higher; NaN where that sample is missing.
    fn shifted(&self, values: &[f64], by: i32) -> Vec<f64> {
        let time = &self.trajectory.time;
        let at = |row: usize| -> Option<f64> {
            let target = row.checked_add_signed(by as isize)?;
            let apart = time.get(target)? - time.get(row)?;
            (apart == by as f64)
                .then(|| values.get(target).copied())
                .flatten()
        };
        (0..values.len())
            .map(|row| at(row).unwrap_or(f64::NAN))
            .collect()
    }

    fn derivative(
        &self,
        values: &[f64],
        below: Signal,
        order: usize,
        crossings: &mut JumpCrossings,
        observer: &mut dyn Observer,
    ) -> Result<SignalValues, Stopped> {
        let declared = self.model.noise(below);
        let noise = declared.map(|noise| noise.rms(values));
        let missing: Vec<bool> = values.iter().map(|x| !x.is_finite()).collect();
        let within = segments(&missing, &self.gaps_and_jumps);
        let mut e =
            derivatives::differentiate(&self.grid, values, &within, order, noise, observer)?;
        // Inputs move the highest derivative of a variable at once.
        let highest = self.model.var(below.var).map_or(1, |v| v.order as usize);
        let driven = below.der as usize + order >= highest;
        let size = if driven { rms(&e.values) } else { 0.0 };
        if self.has_jumps {
            let across = segments(&missing, &self.gaps);
            let wide =
                derivatives::differentiate(&self.grid, values, &across, order, noise, observer)?;
            self.cross_jumps(&mut e, wide, size);
            let short = within
                .iter()
                .filter(|s| s.len() < SAMPLING.min_rows_between_jumps);
            crossings.crossed += short.map(|s| s.rows_end - s.start).sum::<usize>();
        }
        if let (Some(declared), Some(rms)) = (declared.filter(SensorNoise::grows), noise) {
            // A window is narrow beside the signal: its readings are about as noisy as the one in its middle.
            for (error, value) in e.error.iter_mut().zip(values) {
                *error *= declared.at(*value) / rms;
            }
        }
        for (error, corner) in e.error.iter_mut().zip(&self.intersample.corners) {
            *error = error.hypot(size * corner);
        }
        crossings.rows += values.len();
        let of = self.model.name(below);
        let correlation = e.correlation();
        let method = format!(
            "local polynomial of {of}, degree {} on {} points",
            e.degree, e.points
        );
        Ok(SignalValues {
            values: e.values,
            estimated: Some(EstimateInfo {
                method,
                correlation,
                error: e.error,
            }),
        })
    }

    /// Takes the estimate `wide`, which ignores jumps, where its error is clearly smaller than that of `e`, which
    /// respects them: segments between jumps may be too short or too noisy.
    fn cross_jumps(&self, e: &mut Estimate, wide: Estimate, size: f64) {
        let mut crossed = 0;
        for (i, (value, error)) in wide.values.iter().zip(&wide.error).enumerate() {
            let (Some(v), Some(s)) = (e.values.get_mut(i), e.error.get_mut(i)) else {
                continue;
            };
            // Across a jump the estimate is the mean of both sides, which its own error does not show. So the
            // difference between the two estimates, beyond the error of the one that respects the jump, counts as bias.
            let bias = ((value - *v).powi(2) - *s * *s).max(0.0);
            let hidden = size * self.intersample.across.get(i).unwrap_or(&0.0);
            let bias = if v.is_nan() { 0.0 } else { bias } + hidden * hidden;
            let error = (error * error + bias).sqrt();
            if v.is_nan() && value.is_finite() || error < SAMPLING.crossing_error * *s {
                (*v, *s) = (*value, error);
                crossed += 1;
            }
        }
        if 2 * crossed > e.values.len() {
            (e.points, e.degree) = (wide.points, wide.degree);
        }
    }
}

/// Root mean square of the finite values.
fn rms(values: &[f64]) -> f64 {
    let finite = values.iter().filter(|v| v.is_finite());
    let (sum, count) = finite.fold((0.0, 0.0), |(s, n), v| (s + v * v, n + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}
