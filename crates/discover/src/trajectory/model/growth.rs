//! How the noise of one sensor grows with the signal, and what that makes of its level.
//!
//! In: a law of noise and its mean over readings. Out: the noise at each value for a level. Estimates nothing.

use sidc_lang::sensor_noise::SensorNoise;

/// How the noise of one sensor grows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Growth {
    /// Noise at each value, but for a factor.
    pub law: SensorNoise,
    /// Its geometric mean over the readings: level · law / mean is the noise.
    pub mean: f64,
    /// Root mean square of the relative noise of the readings.
    pub rms: f64,
}

impl Growth {
    /// The noise at each value for a level of the sensor.
    pub fn of_level(&self, level: f64) -> SensorNoise {
        SensorNoise {
            floor: self.law.floor * level / self.mean,
            share: self.law.share * level / self.mean,
        }
    }
}
