//! A Monte Carlo estimate of the restricted isometry constants: how far random sparse combinations of unit columns keep their length.
//!
//! In: a Gram matrix, a number of terms. Out: figures, the same for the same seed. They are lower bounds, since the exact constants are
//! hard to compute: the worst support of that size is at least as bad as the worst one drawn.

use super::gram_matrix::GramMatrix;
use crate::SplitMix;
use crate::identifiability::thresholds::RESTRICTED_ISOMETRY;
use sidc_system::discovery::Isometry;

const SEED: u64 = 1;

/// `None` for fewer columns than terms.
pub fn restricted_isometry(gram: &GramMatrix, terms: usize) -> Option<Isometry> {
    if terms == 0 || gram.len() < terms {
        return None;
    }
    let draws = RESTRICTED_ISOMETRY.draws;
    let mut random = SplitMix::new(SEED);
    let mut out = Isometry {
        terms,
        draws,
        seed: SEED,
        least: f64::INFINITY,
        smallest: f64::INFINITY,
        ..Isometry::default()
    };
    let mut columns: Vec<usize> = (0..gram.len()).collect();
    for draw in 0..draws {
        for i in 0..terms {
            let j = i + random.below(columns.len() - i);
            columns.swap(i, j);
        }
        let (chosen, _) = columns.split_at(terms);
        let weights: Vec<f64> = chosen.iter().map(|_| random.normal()).collect();
        let square: f64 = weights.iter().map(|w| w * w).sum();
        let mut length = 0.0;
        for (i, a) in chosen.iter().zip(&weights) {
            for (j, b) in chosen.iter().zip(&weights) {
                length += a * b * gram.cosine(*i, *j);
            }
        }
        let ratio = length.max(0.0) / square.max(f64::MIN_POSITIVE);
        out.least = out.least.min(ratio);
        out.most = out.most.max(ratio);
        out.mean += ratio / draws as f64;
        if draw < RESTRICTED_ISOMETRY.singular_value_draws
            && let Some((least, most)) = gram.extreme_singular_values(chosen)
        {
            out.smallest = out.smallest.min(least);
            out.largest = out.largest.max(most);
        }
    }
    Some(out)
}
