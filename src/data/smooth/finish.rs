//! The curve itself, in units of the data, with standard errors.
//!
//! In: a record, its outliers, a settled stiffness. Out: a [`Smoothed`]. Decides nothing but whether there was anything to smooth.

use super::Smoothed;
use super::posterior::{STATES, State, Sweep};
use super::record::Record;
use super::settle::Settled;
use crate::data::derivatives;

/// A spline that takes more of the values than this only interpolates.
const SATURATED: f64 = 0.7;
/// Part of the posterior variance of value, slope and curvature that is reported. Of it the share (1 − (2d + 1)/6) is noise
/// that was let through, the rest what a signal as rough as the spline's prior would hide. Motion is smoother than that: half.
const SHARE: [f64; STATES] = [11.0 / 12.0, 9.0 / 12.0, 7.0 / 12.0];

impl Record<'_> {
    pub(super) fn finish(
        &self,
        outliers: Vec<usize>,
        settled: Settled,
        sweep: &mut Sweep,
    ) -> Smoothed {
        let mut weights = self.present();
        for row in &outliers {
            if let Some(w) = weights.get_mut(*row) {
                *w = 0.0;
            }
        }
        let m = self.values.len();
        let channel = self.channel(settled.chain, &weights);
        let mut states = vec![State::default(); m];
        let (mut freedom, mut energy) = (0.0, 0.0);
        sweep.run(
            channel.chain,
            channel.values,
            channel.weights,
            settled.fit.width,
            |k, state| {
                let Some(node) = channel.chain.get(k) else {
                    return;
                };
                if node.sees {
                    let ([mean, ..], [variance, ..]) = (state.mean, state.variance);
                    let weight = weights.get(node.row).unwrap_or(&0.0);
                    let value = self.values.get(node.row).unwrap_or(&0.0);
                    freedom += weight * variance;
                    energy += weight * value * (value - mean);
                }
                // Of two nodes at one row the later one is met first: it is the right side.
                let second = channel.chain.get(k + 1).is_some_and(|n| n.row == node.row);
                if let Some(s) = states.get_mut(node.row).filter(|_| !second) {
                    *s = state;
                }
            },
        );
        let mut out = Smoothed {
            sigma: settled.sigma * self.spread,
            freedom,
            lambda: settled.fit.width.powi(6),
            outliers,
            ..Smoothed::default()
        };
        let count: f64 = weights.iter().sum();
        if freedom <= SATURATED * count {
            let sigma = settled.sigma * settled.repeats.sqrt();
            let error = |row: usize| match weights.get(row) {
                Some(w) if *w > 0.0 => SHARE.map(|s| s.sqrt() * sigma),
                _ => [sigma; STATES],
            };
            self.unscale(&states, error, &mut out);
        } else {
            // At the optimum Σ w y (y − x) is all of the objective, of which each value brings one unit of variance.
            let driven = f64::max(energy, 0.0) / (count - STATES as f64).max(1.0);
            let error = settled.sigma.max(driven.sqrt());
            self.unscale(&states, |_| [error; STATES], &mut out);
            self.keep_data(&weights, &mut out);
        }
        out
    }

    /// `error(row)`: what stands for unit noise.
    fn unscale(
        &self,
        states: &[State],
        error: impl Fn(usize) -> [f64; STATES],
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
            for (((to, variance), unit), noise) in errors.zip(error(row)) {
                to.push(noise * variance.sqrt() * unit);
            }
        }
    }

    /// Nothing to smooth: the values are the data, and local polynomials of many samples know the derivatives better.
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
        (out.freedom, out.lambda) = (kept as f64, 0.0);
        let pieces = self.cut(weights);
        let sigma = Some(out.sigma / self.spread);
        let [_, slope_error, curvature_error] = &mut out.error;
        let derivatives = [
            (&mut out.slope, slope_error),
            (&mut out.curvature, curvature_error),
        ];
        for (order, (to, error)) in (1..).zip(derivatives) {
            let go_on = &mut || true;
            let found =
                derivatives::differentiate(&self.grid, &self.values, &pieces, order, sigma, go_on);
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
