//! How the errors of coefficients that were estimated together depend on each other.
//!
//! Plain data of the result document: coefficients by names, so that a reader needs no order.

use serde::{Deserialize, Serialize};

/// The correlations of coefficients that one fit gave.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Correlations {
    /// Each coefficient by the target of its equation and its term; an unknown constant by an empty target and its name.
    pub of: Vec<(String, String)>,
    /// The correlation of each with those before it, row by row below the diagonal.
    pub below: Vec<f64>,
}

impl Correlations {
    /// The place of a coefficient.
    pub fn place(&self, target: &str, term: &str) -> Option<usize> {
        self.of.iter().position(|(a, b)| a == target && b == term)
    }

    /// The correlation of the coefficients at two places.
    pub fn between(&self, i: usize, j: usize) -> Option<f64> {
        match i == j {
            true => Some(1.0),
            false => {
                let (row, column) = (i.max(j), i.min(j));
                self.below.get(row * (row - 1) / 2 + column).copied()
            }
        }
    }

    /// Whether there are as many numbers as pairs, each a correlation.
    pub fn is_sound(&self) -> bool {
        let n = self.of.len();
        self.below.len() == n * n.saturating_sub(1) / 2 && self.below.iter().all(|r| r.abs() <= 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Correlations;

    #[test]
    fn pairs_are_found_in_either_order() {
        let of = ["a", "b", "c"].map(|t| ("dx".to_string(), t.to_string()));
        let all = Correlations {
            of: of.to_vec(),
            below: vec![0.1, 0.2, 0.3],
        };
        assert!(all.is_sound());
        let place = |t: &str| all.place("dx", t).unwrap();
        let pair = |a: &str, b: &str| all.between(place(a), place(b));
        assert_eq!(
            (pair("a", "b"), pair("c", "a"), pair("b", "c")),
            (Some(0.1), Some(0.2), Some(0.3))
        );
        assert_eq!(pair("b", "b"), Some(1.0));
        assert_eq!(all.place("dy", "a"), None);
    }
}
