//! The smoothed curve in units of the data, with standard errors.
//!
//! In: a scaled channel, its outliers and the fit selected for it. Out: a [`Smoothed`]. Decides only whether there is anything
//! to smooth.

use sidc_progress::Unwatched;

use super::information_smoother::{InformationSmoother, STATES, State};
use super::noise_selection::SelectedFit;
use super::scaled_channel::ScaledChannel;
use super::thresholds::SMOOTHING;
use crate::derivatives;

/// One channel along one trajectory of M rows.
#[derive(Clone, Debug, Default)]
pub struct Smoothed {
    /// Smoothed values, in units of the data. All vectors have length M.
    pub values: Vec<f64>,
    /// First derivative, per second; where it jumps, the one to the right.
    pub slope: Vec<f64>,
    /// Second derivative, per second squared.
    pub curvature: Vec<f64>,
    /// Standard errors of value, slope and curvature.
    pub error: [Vec<f64>; STATES],
    /// Standard deviation of the sensor's noise.
    pub sigma: f64,
    /// Effective degrees of freedom, M if nothing was smoothed away.
    pub degrees_of_freedom: f64,
    /// Weight of ∫ x‴² dt against Σ (y − x)², time in median steps; 0 if nothing was smoothed away. Its sixth root
    /// is how many samples the smoother averages over.
    pub lambda: f64,
    /// Rows of outliers, rising; they had no weight.
    pub outliers: Vec<usize>,
}

impl ScaledChannel<'_> {
    pub(super) fn smoothed(
        &self,
        outliers: Vec<usize>,
        selected: SelectedFit,
        smoother: &mut InformationSmoother,
    ) -> Smoothed {
        let weights = self.weights_without(&outliers);
        let channel = self.channel(selected.break_model, &weights);
        let mut states = vec![State::default(); self.values.len()];
        let (mut degrees_of_freedom, mut energy) = (0.0, 0.0);
        let width = selected.fit.width;
        smoother.run(
            channel.nodes,
            channel.values,
            &weights,
            width,
            |k, state| {
                let Some(node) = channel.nodes.get(k) else {
                    return;
                };
                if node.uses_reading {
                    let (weight, value) = (channel.weight(node.row), channel.value(node.row));
                    degrees_of_freedom += weight * state.variance[0];
                    energy += weight * value * (value - state.mean[0]);
                }
                // At a jump a row has two nodes; the second, which is visited first, has the derivatives to the right.
                let second = channel.nodes.get(k + 1).is_some_and(|n| n.row == node.row);
                if let Some(s) = states.get_mut(node.row).filter(|_| !second) {
                    *s = state;
                }
            },
        );
        let mut out = Smoothed {
            sigma: selected.sigma * self.spread,
            degrees_of_freedom,
            lambda: width.powi(6),
            outliers,
            ..Smoothed::default()
        };
        let count: f64 = weights.iter().sum();
        if degrees_of_freedom <= SMOOTHING.saturated * count {
            let sigma = selected.sigma * selected.repeats.sqrt();
            let scale = |row: usize| match weights.get(row) {
                Some(w) if *w > 0.0 => SMOOTHING.variance_share.map(|s| s.sqrt() * sigma),
                _ => [sigma; STATES],
            };
            self.unscale(&states, scale, &mut out);
        } else {
            // At the optimum Σ w y (y − x) is the whole objective, to which each value adds one unit of variance.
            let driven = f64::max(energy, 0.0) / (count - STATES as f64).max(1.0);
            let sigma = selected.sigma.max(driven.sqrt());
            self.unscale(&states, |_| [sigma; STATES], &mut out);
            self.keep_data(&weights, &mut out);
        }
        out
    }

    /// Writes states and errors in units of the data; `scale(row)` is the standard deviation that replaces unit noise.
    fn unscale(
        &self,
        states: &[State],
        scale: impl Fn(usize) -> [f64; STATES],
        out: &mut Smoothed,
    ) {
        let units = [
            self.spread,
            self.spread / self.step,
            self.spread / (self.step * self.step),
        ];
        for (row, state) in states.iter().enumerate() {
            let [x, v, a] = state.mean;
            out.values.push(self.centre + x * units[0]);
            out.slope.push(v * units[1]);
            out.curvature.push(a * units[2]);
            let errors = out.error.iter_mut().zip(state.variance).zip(units);
            for (((to, variance), unit), sigma) in errors.zip(scale(row)) {
                to.push(sigma * variance.sqrt() * unit);
            }
        }
    }

    /// Where there is nothing to smooth: the values are the data, and the derivatives those of local polynomials, which use
    /// more samples than an interpolating spline.
    fn keep_data(&self, weights: &[f64], out: &mut Smoothed) {
        let mut kept = 0;
        for (row, _) in weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
            if let Some((v, raw)) = out.values.get_mut(row).zip(self.raw.get(row)) {
                *v = *raw;
            }
            if let Some(e) = out.error.first_mut().and_then(|e| e.get_mut(row)) {
                *e = out.sigma;
            }
            kept += 1;
        }
        (out.degrees_of_freedom, out.lambda) = (kept as f64, 0.0);
        let segments = self.weighted_segments(weights);
        let sigma = Some(out.sigma / self.spread);
        let [_, slope_error, curvature_error] = &mut out.error;
        let derivatives = [
            (&mut out.slope, slope_error),
            (&mut out.curvature, curvature_error),
        ];
        for (order, (to, error)) in (1..).zip(derivatives) {
            let found = derivatives::differentiate(
                &self.grid,
                &self.values,
                &segments,
                order,
                sigma,
                &mut Unwatched,
            );
            let Ok(found) = found else { continue };
            let rows = to.iter_mut().zip(error.iter_mut());
            for ((d, e), (v, s)) in rows.zip(found.values.iter().zip(&found.error)) {
                if v.is_finite() && s.is_finite() {
                    (*d, *e) = (v * self.spread, s * self.spread);
                }
            }
        }
    }
}
