//! What residuals say about their own errors: serial correlation, and whether they are white.

mod autoregression;
mod whiteness;

pub use autoregression::{Autoregression, WeightedSum};
pub use whiteness::{WHITENESS_LAGS, rms_autocorrelation, white_noise_bound};
