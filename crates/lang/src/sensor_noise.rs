//! The noise of a sensor: how uncertain a reading is, given the value that is read.
//!
//! In: what a model declares or an estimate finds. Out: standard deviations. Knows no data.

use std::fmt;

/// Noise of standard deviation √(floor² + (share · value)²) at a value: a constant part, and one that grows with the signal
/// (Rocke & Lorenzato, Technometrics 1995).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorNoise {
    /// In units of the signal.
    pub floor: f64,
    /// As a part of the value.
    pub share: f64,
}

impl SensorNoise {
    /// The same noise at every value.
    pub fn constant(deviation: f64) -> SensorNoise {
        SensorNoise {
            floor: deviation,
            share: 0.0,
        }
    }

    /// Whether it grows with the signal.
    pub fn grows(&self) -> bool {
        self.share > 0.0
    }

    /// Whether it is a valid noise: no part is negative or infinite, and one is above 0.
    pub fn is_valid(&self) -> bool {
        let part = |x: f64| x >= 0.0 && x.is_finite();
        part(self.floor) && part(self.share) && self.floor + self.share > 0.0
    }

    /// Standard deviation of a reading of this value.
    pub fn at(&self, value: f64) -> f64 {
        match self.grows() {
            true => self.floor.hypot(self.share * value),
            false => self.floor,
        }
    }

    /// Root mean square of the standard deviations of readings of these values; values that are not finite are skipped.
    pub fn rms<'a>(&self, values: impl IntoIterator<Item = &'a f64>) -> f64 {
        if !self.grows() {
            return self.floor;
        }
        let finite = values.into_iter().filter(|v| v.is_finite());
        let (sum, count) = finite.fold((0.0, 0.0), |(s, n), v| (s + v * v, n + 1.0));
        self.at((sum / f64::max(count, 1.0)).sqrt())
    }
}

/// As written in the language: `0.01`, `2%`, `0.01+2%`.
impl fmt::Display for SensorNoise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = 100.0 * self.share;
        match (self.floor > 0.0, self.grows()) {
            (_, false) => write!(f, "{}", self.floor),
            (false, true) => write!(f, "{percent}%"),
            (true, true) => write!(f, "{}+{percent}%", self.floor),
        }
    }
}
