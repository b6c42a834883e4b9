//! Random numbers that are the same on every machine: SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).

pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
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
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }

    /// `len` samples that stay constant for `hold` (fewest, most) samples, uniform in ±`amplitude`, two decimals.
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
