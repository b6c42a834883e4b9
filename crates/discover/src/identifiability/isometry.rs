//! How far random sparse combinations of unit columns keep their length: a Monte Carlo of the restricted isometry.
//!
//! In: cosines of columns, a number of terms. Out: one line of figures, the same for the same seed. It estimates from below what is
//! hard to compute: the worst support of that size is at least as bad as the worst one drawn.

use super::gram::Gram;
use crate::SplitMix;
use sidc_system::discovery::Isometry;

const DRAWS: usize = 1000;
/// Draws of which the singular values are taken as well.
const FACTORED: usize = 200;
const SEED: u64 = 1;

/// `None` for fewer columns than terms.
pub(super) fn isometry(gram: &Gram, terms: usize) -> Option<Isometry> {
    if terms == 0 || gram.len() < terms {
        return None;
    }
    let mut random = SplitMix::new(SEED);
    let mut out = Isometry {
        terms,
        draws: DRAWS,
        seed: SEED,
        least: f64::INFINITY,
        smallest: f64::INFINITY,
        ..Isometry::default()
    };
    let mut places: Vec<usize> = (0..gram.len()).collect();
    for draw in 0..DRAWS {
        for i in 0..terms {
            let j = i + random.below(places.len() - i);
            places.swap(i, j);
        }
        let (chosen, _) = places.split_at(terms);
        let weights: Vec<f64> = chosen.iter().map(|_| random.normal()).collect();
        let square: f64 = weights.iter().map(|w| w * w).sum();
        let mut length = 0.0;
        for (i, a) in chosen.iter().zip(&weights) {
            for (j, b) in chosen.iter().zip(&weights) {
                length += a * b * gram.at(*i, *j);
            }
        }
        let ratio = length.max(0.0) / square.max(f64::MIN_POSITIVE);
        out.least = out.least.min(ratio);
        out.most = out.most.max(ratio);
        out.mean += ratio / DRAWS as f64;
        if draw < FACTORED
            && let Some((least, most)) = gram.extremes(chosen)
        {
            out.smallest = out.smallest.min(least);
            out.largest = out.largest.max(most);
        }
    }
    Some(out)
}
