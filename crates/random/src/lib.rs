//! Pseudorandom numbers for unit tests: the same in every run and on every machine.

/// Knuth's linear congruential generator modulo 2⁶⁴, with a seed.
pub struct Numbers(pub u64);

impl Numbers {
    /// A number from −1 to 1.
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn many(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.next()).collect()
    }
}
