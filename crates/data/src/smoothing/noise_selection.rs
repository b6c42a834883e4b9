//! Which noise, which breaks and which smoothing parameter a channel gets.
//!
//! In: a scaled channel and weights. Out: a [`SelectedFit`]. Asks the criteria of `smoothing_parameter`, and overrules
//! cross-validation where its assumptions fail: on rounded values, and on records whose noise is too small to see.

use super::information_smoother::InformationSmoother;
use super::scaled_channel::{ScaledChannel, uninterrupted};
use super::smoothing_parameter::{self, Channel, Criterion, Fit};
use super::thresholds::{SEARCH, SMOOTHING};
use crate::derivatives::{noise_level, quantization_noise};
use crate::order_statistics::{MEDIAN_OF_ABS_NORMAL, median};
use crate::segmentation::Segment;

/// A smoothing parameter and the noise it was chosen for.
#[derive(Clone, Copy, Debug)]
pub(super) struct SelectedFit {
    /// Which of the channel's models of its breaks.
    pub break_model: usize,
    pub fit: Fit,
    /// Standard deviation of the noise, in units of the channel.
    pub sigma: f64,
    /// Mean number of samples for which the noise keeps its value, as rounding does: 1 for white noise.
    pub repeats: f64,
}

impl SelectedFit {
    /// True if the spline has so many degrees of freedom that its residual may be bias instead of noise.
    pub(super) fn is_doubtful(&self) -> bool {
        self.fit.degrees_of_freedom > SMOOTHING.doubtful * self.fit.count
    }
}

impl ScaledChannel<'_> {
    /// Chooses breaks, noise and smoothing parameter. `near`: the width found for nearly the same weights, about which it
    /// is searched.
    pub(super) fn select_fit(
        &self,
        weights: &[f64],
        sigma: Option<f64>,
        near: Option<f64>,
        smoother: &mut InformationSmoother,
    ) -> SelectedFit {
        let (criterion, min) = match sigma {
            Some(s) => (Criterion::Mallows(s * s), SMOOTHING.min_width),
            None => (
                Criterion::CrossValidation,
                SMOOTHING.min_width_unknown_noise,
            ),
        };
        let max = self.max_width();
        let ratio = SEARCH.warm_start_ratio;
        let range = match near {
            Some(w) => ((w / ratio).max(min), (w * ratio).min(max)),
            None => (min, max),
        };
        let tried = (0..self.break_models.len()).map(|model| {
            let channel = self.channel(model, weights);
            let fit = smoothing_parameter::select(&channel, criterion, range, smoother);
            (model, fit)
        });
        // On equal scores the model with all breaks is taken, which comes first.
        let best = tried.min_by(|(_, a), (_, b)| a.score(criterion).total_cmp(&b.score(criterion)));
        let (break_model, fit) = best.unwrap_or_else(|| {
            let channel = self.channel(0, weights);
            (0, smoothing_parameter::evaluate(&channel, 1.0, smoother))
        });
        let selected = SelectedFit {
            break_model,
            fit,
            repeats: 1.0,
            sigma: sigma.unwrap_or(fit.variance().sqrt().max(self.rounding_error())),
        };
        match sigma {
            Some(_) => selected,
            None => self.review(selected, weights, smoother),
        }
    }

    /// Corrects cross-validation, which assumes white noise and a curve that the spline can follow. Rounded values violate
    /// the first, clean records the second.
    fn review(
        &self,
        selected: SelectedFit,
        weights: &[f64],
        smoother: &mut InformationSmoother,
    ) -> SelectedFit {
        let channel = self.channel(selected.break_model, weights);
        let range = (SMOOTHING.min_width, self.max_width());
        let rounding = quantization_noise(&self.values, &uninterrupted(weights));
        if rounding > 0.0 && selected.sigma <= SMOOTHING.rounding * rounding {
            let criterion = Criterion::Bounded(rounding * rounding);
            return SelectedFit {
                fit: smoothing_parameter::select(&channel, criterion, range, smoother),
                sigma: rounding,
                repeats: self.repeats(),
                ..selected
            };
        }
        let count = selected.fit.count;
        if !selected.is_doubtful() || count < SMOOTHING.min_values_for_differences {
            return selected;
        }
        let seen = self.difference_noise(weights);
        let ratio = match count < SMOOTHING.many_values {
            true => SMOOTHING.noise_ratio_of_few,
            false => SMOOTHING.noise_ratio,
        };
        if seen < ratio * self.median_residual(&channel, &selected, smoother) {
            let criterion = Criterion::Mallows(seen * seen);
            return SelectedFit {
                fit: smoothing_parameter::select(&channel, criterion, range, smoother),
                sigma: seen,
                ..selected
            };
        }
        selected
    }

    /// Mean number of samples from one change of the value to the next.
    fn repeats(&self) -> f64 {
        let changes = self.values.windows(2).filter(|w| w[0] != w[1]).count();
        self.values.len() as f64 / changes.max(1) as f64
    }

    /// Noise as high differences show it, but no less than rounding in memory.
    fn difference_noise(&self, weights: &[f64]) -> f64 {
        let mut segments = self.weighted_segments(weights);
        let rows: usize = segments.iter().map(Segment::len).sum();
        if rows < SMOOTHING.min_segment * segments.len() {
            segments = uninterrupted(weights);
        }
        let seen = noise_level(&self.grid, &self.values, &segments);
        seen.max(self.rounding_error())
    }

    /// Rounding error of the values in memory.
    pub(super) fn rounding_error(&self) -> f64 {
        f64::max(1.0, self.centre.abs() / self.spread) * f64::EPSILON
    }

    /// Width of the stiffest spline that is tried, in median steps.
    fn max_width(&self) -> f64 {
        let time = self.grid.time();
        let span = time.last().unwrap_or(&0.0) - time.first().unwrap_or(&0.0);
        f64::max(SMOOTHING.max_width * span / self.step, 2.0)
    }

    /// Standard deviation of the residuals by their median, which a few outliers do not move.
    fn median_residual(
        &self,
        channel: &Channel,
        selected: &SelectedFit,
        smoother: &mut InformationSmoother,
    ) -> f64 {
        let mut residuals = Vec::with_capacity(channel.values.len());
        channel.for_each_row(selected.fit.width, smoother, |row, state| {
            if channel.weight(row) > 0.0 {
                let free = (1.0 - state.variance[0]).max(1e-6).sqrt();
                residuals.push((channel.value(row) - state.mean[0]).abs() / free);
            }
        });
        median(&mut residuals).unwrap_or(0.0) / MEDIAN_OF_ABS_NORMAL
    }
}

/// The value below which the part `q` of the values lies; 0 if there are none.
pub(super) fn quantile(values: &mut [f64], q: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let at = ((values.len() as f64 * q) as usize).min(values.len() - 1);
    let (_, value, _) = values.select_nth_unstable_by(at, f64::total_cmp);
    *value
}
