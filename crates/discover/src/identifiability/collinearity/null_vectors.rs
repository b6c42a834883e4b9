//! Sparse null vectors: combinations of few columns that nearly vanish, around chosen columns.
//!
//! In: unit columns and their Gram matrix. Out: relations, largest weight 1, measured on the columns themselves. Pairs and triples are
//! searched exhaustively; longer relations extend the best of these by a beam search. The relations are sparse members of the null
//! space, not a basis. Knows no names.

use std::collections::BTreeSet;

use super::gram_matrix::GramMatrix;
use crate::identifiability::thresholds::NULL_VECTORS;
use crate::scaled_design::OrthonormalBasis;

/// Columns of a relation, rising, their weights as unit columns (largest 1), and the length of the residual.
#[derive(Clone, Debug, PartialEq)]
pub struct NullVector {
    pub indices: Vec<usize>,
    pub weights: Vec<f64>,
    pub residual: f64,
}

pub struct NullVectorSearch<'a> {
    pub gram: &'a GramMatrix,
    pub columns: Vec<&'a [f64]>,
    /// Largest residual of a relation of two, three, … columns.
    pub max_residuals: [f64; 5],
}

impl NullVectorSearch<'_> {
    /// Relations that contain one of the seeds, every set of columns once, without those in which fewer columns do as well.
    pub fn around(&self, seeds: &[usize]) -> Vec<NullVector> {
        let mut met = BTreeSet::new();
        let mut found: Vec<NullVector> = Vec::new();
        for seed in seeds {
            for indices in self.candidates(*seed) {
                if met.insert(indices.clone())
                    && let Some(null) = self.measure(&indices)
                    && found.iter().all(|f| f.indices != null.indices)
                {
                    found.push(null);
                }
            }
        }
        found.sort_by(|a, b| {
            let length = a.indices.len().cmp(&b.indices.len());
            length.then(a.residual.total_cmp(&b.residual))
        });
        let mut kept: Vec<NullVector> = Vec::new();
        for null in found {
            let inside = |k: &NullVector| k.indices.iter().all(|p| null.indices.contains(p));
            let bound = NULL_VECTORS.superfluous * null.residual.max(1e-15);
            let superfluous = kept.iter().any(|k| inside(k) && k.residual < bound);
            if !superfluous {
                kept.push(null);
            }
        }
        kept
    }

    /// The relation between these columns, without those of negligible weight; `None` if its residual is too large.
    pub fn measure(&self, indices: &[usize]) -> Option<NullVector> {
        let null = self.null_vector(indices)?;
        let limit = self.max_residuals.get(null.indices.len() - 2)?;
        (null.residual <= *limit).then_some(null)
    }

    /// The combination of these columns with the smallest residual, however large, without those of negligible weight.
    pub fn null_vector(&self, indices: &[usize]) -> Option<NullVector> {
        let mut indices = indices.to_vec();
        indices.sort_unstable();
        loop {
            if indices.len() < 2 {
                return None;
            }
            let basis = OrthonormalBasis::of(indices.iter().map(|p| self.columns[*p]));
            let (weights, residual) = basis.near_dependency()?;
            let least = weights.iter().map(|w| w.abs()).fold(1.0, f64::min);
            let negligible = (NULL_VECTORS.negligible_weight * residual)
                .clamp(NULL_VECTORS.rounding, NULL_VECTORS.certain_weight);
            if least >= negligible || indices.len() == 2 {
                return Some(NullVector {
                    indices,
                    weights,
                    residual: residual.max(f64::EPSILON),
                });
            }
            let at = weights.iter().position(|w| w.abs() == least)?;
            indices.remove(at);
        }
    }

    fn candidates(&self, seed: usize) -> Vec<Vec<usize>> {
        let pairs = self.pairs(seed);
        let triples = self.triples(seed);
        let squares = self.max_residuals.map(|l| l * l);
        let mut out: Vec<Vec<usize>> = Vec::new();
        let within = |all: &[(f64, Vec<usize>)], limit: f64| -> Vec<Vec<usize>> {
            // What rounding lets through is measured on the columns.
            let bound = limit + NULL_VECTORS.product_rounding;
            let within = all.iter().filter(|(left, _)| *left <= bound);
            within
                .take(NULL_VECTORS.kept)
                .map(|(_, p)| p.clone())
                .collect()
        };
        out.extend(within(&pairs, squares[0]));
        out.extend(within(&triples, squares[1]));
        let mut beam: Vec<Vec<usize>> = triples
            .into_iter()
            .take(NULL_VECTORS.beam_width)
            .map(|t| t.1)
            .collect();
        for limit in squares.iter().skip(2) {
            let extended = self.extend(seed, &beam);
            out.extend(within(&extended, *limit));
            beam = extended
                .into_iter()
                .take(NULL_VECTORS.beam_width)
                .map(|g| g.1)
                .collect();
        }
        out
    }

    /// Each other column with the squared residual of the seed on it, least first.
    fn pairs(&self, seed: usize) -> Vec<(f64, Vec<usize>)> {
        let cosines = self.gram.column(seed).iter().enumerate();
        let others = cosines.filter(|(j, _)| *j != seed);
        let mut all: Vec<(f64, usize)> = others.map(|(j, g)| (1.0 - g * g, j)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let named = all
            .into_iter()
            .take(NULL_VECTORS.beam_width.max(NULL_VECTORS.kept));
        named.map(|(left, j)| (left, vec![seed, j])).collect()
    }

    /// Pairs of other columns with the squared residual of the seed on them, least first.
    fn triples(&self, seed: usize) -> Vec<(f64, Vec<usize>)> {
        let n = self.gram.len();
        if n > NULL_VECTORS.exhaustive_columns {
            return self.extend(
                seed,
                &self
                    .pairs(seed)
                    .into_iter()
                    .map(|p| p.1)
                    .collect::<Vec<_>>(),
            );
        }
        let own = self.gram.column(seed);
        let mut best: Vec<(f64, usize, usize)> = Vec::new();
        let mut largest = f64::INFINITY;
        for j in (0..n).filter(|j| *j != seed) {
            let (a, with) = (own[j], self.gram.column(j));
            for k in 0..j {
                let (b, c) = (own[k], with[k]);
                let room = 1.0 - c * c;
                if k == seed || room < NULL_VECTORS.dependent_pair {
                    continue;
                }
                let left = 1.0 - (a * a + b * b - 2.0 * a * b * c) / room;
                if left < largest {
                    best.push((left.max(0.0), k, j));
                    if best.len() > 8 * NULL_VECTORS.beam_width {
                        best.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
                        best.truncate(NULL_VECTORS.beam_width);
                        largest = best.last().map_or(largest, |b| b.0);
                    }
                }
            }
        }
        best.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        best.truncate(NULL_VECTORS.beam_width);
        let named = best
            .into_iter()
            .map(|(left, k, j)| (left, vec![seed, k, j]));
        named.collect()
    }

    /// The sets with one more column and the squared residual of the seed on the others, least first.
    fn extend(&self, seed: usize, sets: &[Vec<usize>]) -> Vec<(f64, Vec<usize>)> {
        let mut seen = BTreeSet::new();
        let mut all: Vec<(f64, Vec<usize>)> = Vec::new();
        for set in sets {
            let Some(projection) = CholeskyProjection::new(self.gram, seed, set) else {
                continue;
            };
            for j in (0..self.gram.len()).filter(|j| !set.contains(j)) {
                let Some(left) = projection.residual_with(j) else {
                    continue;
                };
                all.push((left, [set.as_slice(), &[j]].concat()));
            }
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        let mut out = Vec::new();
        for (left, set) in all {
            let mut sorted = set.clone();
            sorted.sort_unstable();
            if seen.insert(sorted) {
                out.push((left, set));
            }
            if out.len() >= NULL_VECTORS.beam_width.max(NULL_VECTORS.kept) {
                break;
            }
        }
        out
    }
}

/// The Cholesky factor of the cosines of a set without the seed, by which the seed is projected on the set.
struct CholeskyProjection<'a> {
    gram: &'a GramMatrix,
    /// The set without the seed.
    others: Vec<usize>,
    /// L by rows.
    lower: Vec<Vec<f64>>,
    /// L⁻¹ of the cosines with the seed.
    along: Vec<f64>,
    seed: usize,
}

impl<'a> CholeskyProjection<'a> {
    fn new(gram: &'a GramMatrix, seed: usize, set: &[usize]) -> Option<Self> {
        let mut projection = CholeskyProjection {
            gram,
            others: Vec::new(),
            lower: Vec::new(),
            along: Vec::new(),
            seed,
        };
        for j in set.iter().filter(|j| **j != seed) {
            let row = projection.forward_substitution(*j);
            let room = 1.0 - row.iter().map(|x| x * x).sum::<f64>();
            if room < NULL_VECTORS.dependent {
                return None;
            }
            let known: f64 = row.iter().zip(&projection.along).map(|(a, b)| a * b).sum();
            let pivot = room.sqrt();
            projection
                .along
                .push((gram.cosine(*j, seed) - known) / pivot);
            projection.others.push(*j);
            projection.lower.push([row, vec![pivot]].concat());
        }
        Some(projection)
    }

    /// L⁻¹ of the cosines with column j.
    fn forward_substitution(&self, j: usize) -> Vec<f64> {
        let mut out: Vec<f64> = Vec::with_capacity(self.others.len());
        for (row, place) in self.lower.iter().zip(&self.others) {
            let known: f64 = row.iter().zip(&out).map(|(a, b)| a * b).sum();
            let pivot = row.last().copied().unwrap_or(1.0);
            out.push((self.gram.cosine(*place, j) - known) / pivot);
        }
        out
    }

    /// The squared residual of the seed on the set and column j.
    fn residual_with(&self, j: usize) -> Option<f64> {
        let row = self.forward_substitution(j);
        let room = 1.0 - row.iter().map(|x| x * x).sum::<f64>();
        if room < NULL_VECTORS.dependent {
            return None;
        }
        let known: f64 = row.iter().zip(&self.along).map(|(a, b)| a * b).sum();
        let gain = (self.gram.cosine(j, self.seed) - known).powi(2) / room;
        let left = 1.0 - self.along.iter().map(|x| x * x).sum::<f64>() - gain;
        Some(left.max(0.0))
    }
}
