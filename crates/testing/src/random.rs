//! Random numbers that are the same on every machine: those of the program, and input signals made from them.

use sidc_discover::SplitMix;

/// SplitMix64 with what simulated rigs need.
pub struct Random(SplitMix);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(SplitMix::new(seed))
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0.unit()
    }

    /// Uniform in [low, high).
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in low..=high.
    pub fn whole(&mut self, low: usize, high: usize) -> usize {
        low + (self.unit() * (high - low + 1) as f64) as usize
    }

    /// Standard normal (Box–Muller).
    pub fn normal(&mut self) -> f64 {
        self.0.normal()
    }

    /// `len` samples of levels uniform in ±`amplitude`, to two decimals, each held for `hold` (fewest, most) samples.
    pub fn square(&mut self, len: usize, hold: (usize, usize), amplitude: f64) -> Vec<f64> {
        let mut values = Vec::with_capacity(len);
        while values.len() < len {
            let level = decimals(self.uniform(-amplitude, amplitude), 2);
            let count = self.whole(hold.0, hold.1).min(len - values.len());
            values.extend(std::iter::repeat_n(level, count));
        }
        values
    }
}

/// `x` rounded to `n` decimals: an actuator has finite resolution, and so has a file that a reader looks at.
pub fn decimals(x: f64, n: i32) -> f64 {
    let scale = 10_f64.powi(n);
    // Adding zero turns -0 into 0.
    (x * scale).round() / scale + 0.0
}
