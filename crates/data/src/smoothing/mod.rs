//! One channel smoothed: its value, slope and curvature at every sample, each with a standard error, and the sensor's noise.
//!
//! In: instants, values (NaN where missing), where derivatives may jump, the noise if it is known. Out: a [`Smoothed`].
//! Never sees names, models or equations.
//!
//! A quintic smoothing spline; its smoothing parameter follows from generalised cross-validation or from the known noise.
//! Where the noise is so small that smoothing would only add bias, the values are the data and the derivatives those of local
//! polynomials.
//!
//! Flow: `scaled_channel` → `outliers` → `noise_selection` → `smoothing_parameter` → `information_smoother`; then
//! `smoothed_curve`.

mod information_smoother;
mod noise_selection;
mod outliers;
mod scaled_channel;
mod smoothed_curve;
mod smoothing_parameter;
pub(crate) mod thresholds;

use information_smoother::InformationSmoother;
use scaled_channel::ScaledChannel;
pub use smoothed_curve::Smoothed;
use thresholds::SMOOTHING;

use crate::segmentation::Break;

/// Smooths `values` at strictly rising `time` (seconds); both of length M.
///
/// NaN marks a missing value, which is bridged. `sigma` is the noise if it is known; otherwise it is estimated. `breaks` are
/// sorted by row; gaps always count, jumps of derivatives of order 1 and 2 only if the criterion is better with them.
/// `robust` gives outliers no weight. Returns `None` for fewer than five values, or if times do not rise.
///
/// Spline and standard errors, which count noise and bias: Wahba 1978, Journal of the Royal Statistical Society B 40.
pub fn smooth(
    time: &[f64],
    values: &[f64],
    sigma: Option<f64>,
    breaks: &[Break],
    robust: bool,
) -> Option<Smoothed> {
    let rising = time.windows(2).all(|w| w[0] < w[1]);
    let present = values.iter().filter(|v| v.is_finite()).count();
    if !rising || present < SMOOTHING.min_values || time.len() != values.len() {
        return None;
    }
    let channel = ScaledChannel::new(time, values, breaks);
    let sigma = sigma
        .filter(|s| *s > 0.0 && s.is_finite())
        .map(|s| s / channel.spread);
    let mut smoother = InformationSmoother::default();
    let (outliers, selected) = if robust {
        outliers::find(&channel, sigma, &mut smoother)
    } else {
        let selected = channel.select_fit(&channel.present(), sigma, None, &mut smoother);
        (Vec::new(), selected)
    };
    Some(channel.smoothed(outliers, selected, &mut smoother))
}
