//! The columns of two dictionaries, one after the other, each with its weights.
//!
//! In: two dictionaries of as many rows. Out: one. Stores nothing.

use super::operator::Dictionary;
use super::pricing::{Priced, PricingCollector};

/// Two dictionaries as one.
pub struct Joined<'a> {
    parts: [&'a dyn Dictionary; 2],
}

impl<'a> Joined<'a> {
    /// Both have the same number of rows.
    pub fn new(parts: [&'a dyn Dictionary; 2]) -> Joined<'a> {
        debug_assert_eq!(parts[0].rows(), parts[1].rows());
        Joined { parts }
    }

    /// The part that holds a column, and its number there.
    fn part(&self, j: usize) -> (&'a dyn Dictionary, usize) {
        let first = self.parts[0].cols();
        match j.checked_sub(first) {
            None => (self.parts[0], j),
            Some(j) => (self.parts[1], j),
        }
    }
}

impl Dictionary for Joined<'_> {
    fn rows(&self) -> usize {
        self.parts[0].rows()
    }

    fn cols(&self) -> usize {
        self.parts.map(|p| p.cols()).iter().sum()
    }

    fn norm(&self, j: usize) -> f64 {
        let (part, j) = self.part(j);
        part.norm(j)
    }

    fn is_finite(&self) -> bool {
        self.parts.iter().all(|p| p.is_finite())
    }

    fn weight(&self, j: usize) -> f64 {
        let (part, j) = self.part(j);
        part.weight(j)
    }

    fn column(&self, j: usize, out: &mut [f64]) {
        let (part, j) = self.part(j);
        part.column(j, out);
    }

    fn price(&self, lambda: &[f64], most: usize, bound: f64) -> Priced {
        let [first, second] = self.parts.map(|p| p.price(lambda, most, bound));
        let after = self.parts[0].cols();
        let mut all = PricingCollector::new(most, bound);
        first.columns.into_iter().for_each(|(j, c)| all.offer(j, c));
        let second = second.columns.into_iter();
        second.for_each(|(j, c)| all.offer(after + j, c));
        all.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dictionary::{Dense, Graded, Grades};

    #[test]
    fn columns_keep_their_weights_and_prices() {
        let values: Vec<f64> = (0..40).map(|i| f64::from(i * 7 % 11) - 4.5).collect();
        let whole = Dense::new(4, values.clone());
        let first = Dense::new(4, values[..24].to_vec());
        let second = Dense::new(4, values[24..].to_vec());
        let lambda = [0.3, -0.4, 0.9, 0.1];
        let both = Joined::new([&first, &second]);
        assert_eq!((both.rows(), both.cols()), (4, 10));
        assert!((0..both.cols()).all(|j| both.norm(j) == whole.norm(j)));
        assert_eq!(both.price(&lambda, 4, 0.1), whole.price(&lambda, 4, 0.1));
        // The grade of a part is that of its columns alone.
        let grades = Grades::of_columns(vec![2.0; 4]);
        let dear = Graded {
            columns: &second,
            grades: &grades,
        };
        let both = Joined::new([&first, &dear]);
        assert_eq!(both.weight(3), whole.weight(3));
        assert_eq!(both.weight(8), 2.0 * whole.weight(8));
        let half = |j: usize, c: f64| if j < 6 { c } else { 0.5 * c };
        for (j, c) in both.price(&lambda, 10, 0.0).columns {
            let plain = whole.price(&lambda, 10, 0.0);
            let plain = plain.columns.iter().find(|p| p.0 == j).map(|p| p.1);
            assert!(plain.is_some_and(|p| (half(j, p) - c).abs() < 1e-15));
        }
    }
}
