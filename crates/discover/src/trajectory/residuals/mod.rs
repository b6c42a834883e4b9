//! What a fit leaves of the readings, and what that says.
//!
//! In: a problem and a fit. Out: residuals of each channel, outliers, the statistical inefficiency of coloured residuals, all signals
//! along the fitted trajectory. Changes no fit.

mod channels;
mod defined_start;
mod effective_sample_size;
mod errors_ahead;
mod fitted_signals;
mod noise_growth;
mod noise_time_constant;
mod outliers;

pub use channels::{Channel, File, channels};
pub(crate) use effective_sample_size::statistical_inefficiency;
pub use errors_ahead::{log_error_ahead, own_time};
pub use noise_growth::{GrownNoise, grow_noise};
pub use noise_time_constant::{LastingNoise, autocorrelated_noise, noise_comes_in_bursts};
pub use outliers::{Outliers, leave_out};
