//! Derivatives of a sampled signal, each with an estimate of its error.
//!
//! In: instants, values, and the segments that no window may leave. Out: a derivative and its standard error at every sample.
//! Never sees names or trajectories.
//!
//! One rule serves clean and noisy records: of local polynomials of many widths and degrees, interpolating ones included, take
//! the one of least estimated mean squared error, σ²‖w‖² + bias² (Fan and Gijbels 1996, Local Polynomial Modelling, ch. 4, for
//! the idea; the estimate of the bias is our own, see `error_estimation`).
//!
//! Flow: `bandwidth_selection` → `error_estimation` → `local_polynomial` → `orthonormal_polynomials`.

mod bandwidth_selection;
mod difference_noise;
mod error_estimation;
mod estimate;
mod local_polynomial;
mod moving_average;
mod orthonormal_polynomials;
mod quantization_noise;
pub(crate) mod thresholds;

pub(crate) use difference_noise::noise_level;
pub use difference_noise::{difference_noise, is_smooth};
pub(crate) use estimate::{Estimate, Stopped};
pub(crate) use orthonormal_polynomials::OrthonormalBasis;
pub(crate) use quantization_noise::quantization_noise;

use sidc_progress::Observer;

use crate::segmentation::Segment;
use crate::time_axis::TimeGrid;

/// Derivative `order` (1 to 3) of `values`, all finite within the segments.
///
/// `noise` is the sensor's standard deviation if known; otherwise it is estimated. Linear in the samples on even grids.
///
/// # Errors
/// [`Stopped`] if the observer, called every few thousand samples, ends the work.
pub(crate) fn differentiate(
    grid: &TimeGrid,
    values: &[f64],
    segments: &[Segment],
    order: usize,
    noise: Option<f64>,
    observer: &mut dyn Observer,
) -> Result<Estimate, Stopped> {
    let sigma = noise.unwrap_or_else(|| noise_level(grid, values, segments));
    bandwidth_selection::least_error(grid, values, segments, order, sigma, observer)
}

#[cfg(test)]
mod tests;
