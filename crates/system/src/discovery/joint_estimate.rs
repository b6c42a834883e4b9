//! What a joint estimate says of one variable: its residuals, its sensors, what drives it besides its law.
//!
//! In: nothing but these types. They are part of the result document.

use serde::{Deserialize, Serialize};

/// Figures of a system estimated jointly with its trajectory, for one variable.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointEvidence {
    /// Every measured derivative of the variable.
    pub channels: Vec<ChannelFit>,
    /// The term whose loss costs least, and what the criterion loses with it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub weakest: Option<(String, f64)>,
    /// Delays that were estimated.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub delays: Vec<InputDelay>,
    /// Inputs that were found to run along cubics between their samples.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub cubic: Vec<String>,
    /// What drives the law besides its terms, if that was estimated with it. The residuals of the channels are then what a reading says beyond
    /// those before it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub disturbance: Option<DisturbanceFit>,
    /// Price of a term in the criterion.
    pub price: f64,
    /// Sets of terms that were fitted.
    pub tried: usize,
    /// The criterion of each tie minus the answer's, in the order of `ties`.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub ties: Vec<f64>,
}

/// What drives a law besides its terms.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DisturbanceFit {
    /// White noise: what it adds to the integral of the target in one unit of time, a standard deviation. Otherwise the standard deviation of
    /// the disturbance itself, in units of the target. 0 where nothing that counts drives the law.
    pub size: f64,
    /// Time constant of its autocorrelation; absent for white noise.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub memory: Option<f64>,
}

/// The delay of an input against its record.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InputDelay {
    pub input: String,
    /// Positive if later.
    pub seconds: f64,
    pub samples: f64,
}

/// Residuals of one measured channel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChannelFit {
    pub signal: String,
    /// Root mean square residual, in the signal's units, and relative to its spread.
    #[serde(rename = "left")]
    pub residual: f64,
    pub relative: f64,
    /// The sensor's noise, declared or estimated by smoothing. Smoothing overestimates it where jumps of an input make
    /// kinks.
    pub noise: f64,
    /// Whether the noise was declared.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub declared: bool,
    /// The noise that the residuals show, where it grows with the signal.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub growing: Option<GrowingNoise>,
    /// Time constant of the noise, where it lasts from sample to sample. `residual` is then the size of the noise, `autocorrelation` that of what is new in
    /// each residual.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub lasting: Option<f64>,
    /// Autocorrelation of the residuals over the first lags, and its bound for white noise.
    #[serde(rename = "memory")]
    pub autocorrelation: f64,
    #[serde(rename = "chance")]
    pub white_noise_bound: f64,
    /// The residual in each file, by name, where sensors differ.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub files: Vec<(String, f64)>,
    /// Readings without weight.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub left_out: usize,
}

/// Noise of standard deviation √(floor² + (share · value)²).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GrowingNoise {
    /// In the signal's units.
    pub floor: f64,
    pub share: f64,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}
