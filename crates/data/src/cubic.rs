//! The cubic that an input follows between two samples.
//!
//! In: instants and values of a signal, the sample before. Out: the polynomial through the four samples nearest to that interval.

use std::array::from_fn;

/// A polynomial of the time that has passed since a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic {
    /// Its coefficients, that of the first power at place 1.
    pub powers: [f64; 4],
}

impl Cubic {
    /// The cubic from sample `k` to the next. `None` where there are fewer than four samples, or one without a value.
    pub fn after(time: &[f64], values: &[f64], k: usize) -> Option<Cubic> {
        let first = k.saturating_sub(1).min(time.len().checked_sub(4)?);
        let start = time.get(k)?;
        let at: [f64; 4] = from_fn(|i| time[first + i] - start);
        // Newton's divided differences.
        let mut differences: [f64; 4] = values.get(first..first + 4)?.try_into().ok()?;
        for order in 1..4 {
            for i in (order..4).rev() {
                differences[i] = (differences[i] - differences[i - 1]) / (at[i] - at[i - order]);
            }
        }
        // By powers: Horner's scheme, from the innermost bracket out.
        let mut powers = [0.0; 4];
        for i in (0..4).rev() {
            for power in (1..4).rev() {
                powers[power] = powers[power - 1] - at[i] * powers[power];
            }
            powers[0] = differences[i] - at[i] * powers[0];
        }
        powers
            .iter()
            .all(|x| x.is_finite())
            .then_some(Cubic { powers })
    }

    /// The same through samples of one uninterrupted piece. `gaps`: the samples before which there is a gap. `None` in a gap too.
    pub fn within_gaps(time: &[f64], values: &[f64], gaps: &[usize], k: usize) -> Option<Cubic> {
        let next = gaps.partition_point(|gap| *gap <= k);
        let start = next.checked_sub(1).map_or(0, |before| gaps[before]);
        let end = gaps.get(next).copied().unwrap_or(time.len());
        if k + 1 == end {
            return None;
        }
        Cubic::after(time.get(start..end)?, values.get(start..end)?, k - start)
    }

    /// Its value, so long after its sample.
    pub fn at(&self, passed: f64) -> f64 {
        self.powers.iter().rev().fold(0.0, |y, a| y * passed + a)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_cubic_through_samples_of_a_cubic_is_that_cubic(
            powers in proptest::array::uniform4(-3.0..3.0f64),
            steps in proptest::collection::vec(0.2..2.0f64, 4..8),
            place in 0..8usize,
        ) {
            let truth = Cubic { powers };
            let time: Vec<f64> = steps.iter().scan(-3.0, |t, h| { *t += h; Some(*t) }).collect();
            let values: Vec<f64> = time.iter().map(|t| truth.at(*t)).collect();
            let k = place % (time.len() - 1);
            let passed = 0.4 * (time[k + 1] - time[k]);
            let found = Cubic::after(&time, &values, k).unwrap();
            prop_assert!((found.at(passed) - truth.at(time[k] + passed)).abs() < 1e-9);
        }
    }
}
