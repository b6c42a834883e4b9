//! Numbers that look random, for tests: the same in every run and on every machine. Not a part of the program.

use crate::dictionary::{Dense, Dictionary};

/// Knuth's linear congruence modulo 2⁶⁴, from a seed.
pub struct Numbers(pub u64);

impl Numbers {
    /// In −1 … 1.
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

    /// Φ of so many rows and columns, and a target that is a sum over some columns with coefficients within 1 of `about`.
    pub fn planted(
        &mut self,
        (rows, cols): (usize, usize),
        support: &[usize],
        about: f64,
    ) -> (Dense, Vec<f64>) {
        let dictionary = Dense::new(rows, self.many(rows * cols));
        let (mut target, mut column) = (vec![0.0; rows], vec![0.0; rows]);
        for j in support {
            dictionary.column(*j, &mut column);
            let coefficient = about + self.next();
            let sum = target.iter_mut().zip(&column);
            sum.for_each(|(y, x)| *y += coefficient * x);
        }
        (dictionary, target)
    }
}
