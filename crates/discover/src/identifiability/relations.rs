//! Few columns that add up to nearly nothing: pairs, then triples, then more, around chosen columns.
//!
//! In: unit columns and their cosines. Out: relations, largest weight 1, measured on the columns themselves. Pairs and triples are
//! searched exhaustively; longer ones grow from the best pairs and triples, a few at a time. A null space has many bases: these are
//! sparse members of it, not one of them. Knows no names.

use std::collections::BTreeSet;

use super::gram::Gram;
use crate::scaled_design::OrthonormalBasis;

/// Columns of a relation, rising, their weights of unit columns (largest 1), and the length of what they leave.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Null {
    pub places: Vec<usize>,
    pub weights: Vec<f64>,
    pub size: f64,
}

/// What a relation of so many columns may leave, from two on: the more columns, the easier a small rest comes by chance.
pub(super) type Limits = [f64; 5];
/// Of a library's columns, where smooth motion makes any few functions alike.
pub(super) const OF_TERMS: Limits = [0.05, 0.01, 1e-6, 1e-6, 1e-6];
/// A rest that is rounding.
pub(super) const EXACT: f64 = 1e-9;
/// A weight under so many rests says nothing.
const CLEAR: f64 = 10.0;
/// Relations of each length that are kept for a column.
const KEPT: usize = 4;
/// Pairs and triples that are grown.
const BEAM: usize = 6;
/// Exhaustive triples up to this many columns.
const TRIPLES: usize = 1500;

pub(super) struct Search<'a> {
    pub gram: &'a Gram,
    pub columns: Vec<&'a [f64]>,
    pub limits: Limits,
}

impl Search<'_> {
    /// Relations in which each of the seeds stands, every set of columns once, none that only pads a smaller one.
    pub fn around(&self, seeds: &[usize]) -> Vec<Null> {
        let mut met = BTreeSet::new();
        let mut found: Vec<Null> = Vec::new();
        for seed in seeds {
            for places in self.candidates(*seed) {
                if met.insert(places.clone())
                    && let Some(null) = self.measure(&places)
                    && found.iter().all(|f| f.places != null.places)
                {
                    found.push(null);
                }
            }
        }
        found.sort_by(|a, b| {
            let length = a.places.len().cmp(&b.places.len());
            length.then(a.size.total_cmp(&b.size))
        });
        let mut kept: Vec<Null> = Vec::new();
        for null in found {
            let inside = |k: &Null| k.places.iter().all(|p| null.places.contains(p));
            let padded = kept
                .iter()
                .any(|k| inside(k) && k.size < 1e6 * null.size.max(1e-15));
            if !padded {
                kept.push(null);
            }
        }
        kept
    }

    /// The relation of these columns alone, less those without a say in it; `None` if it is none.
    pub fn measure(&self, places: &[usize]) -> Option<Null> {
        let null = self.nearest(places)?;
        let limit = self.limits.get(null.places.len() - 2)?;
        (null.size <= *limit).then_some(null)
    }

    /// The combination of these columns nearest to nothing, whatever it leaves, less those without a say in it.
    pub fn nearest(&self, places: &[usize]) -> Option<Null> {
        let mut places = places.to_vec();
        places.sort_unstable();
        loop {
            if places.len() < 2 {
                return None;
            }
            let basis = OrthonormalBasis::of(places.iter().map(|p| self.columns[*p]));
            let (weights, size) = basis.near_dependency()?;
            let least = weights.iter().map(|w| w.abs()).fold(1.0, f64::min);
            if least >= (CLEAR * size).clamp(EXACT, 0.5) || places.len() == 2 {
                let size = size.max(f64::EPSILON);
                return Some(Null {
                    places,
                    weights,
                    size,
                });
            }
            let at = weights.iter().position(|w| w.abs() == least)?;
            places.remove(at);
        }
    }

    fn candidates(&self, seed: usize) -> Vec<Vec<usize>> {
        let pairs = self.pairs(seed);
        let triples = self.triples(seed);
        let near = self.limits.map(|l| l * l);
        let mut out: Vec<Vec<usize>> = Vec::new();
        let within = |all: &[(f64, Vec<usize>)], limit: f64| -> Vec<Vec<usize>> {
            // Products of columns leave 1e-8 of a rest, squared 1e-16; a little above is taken, and measured.
            let near = all.iter().filter(|(left, _)| *left <= limit + 1e-13);
            near.take(KEPT).map(|(_, p)| p.clone()).collect()
        };
        out.extend(within(&pairs, near[0]));
        out.extend(within(&triples, near[1]));
        let mut beam: Vec<Vec<usize>> = triples.into_iter().take(BEAM).map(|t| t.1).collect();
        for limit in near.iter().skip(2) {
            let grown = self.grow(seed, &beam);
            out.extend(within(&grown, *limit));
            beam = grown.into_iter().take(BEAM).map(|g| g.1).collect();
        }
        out
    }

    /// What each other column alone leaves of the seed, squared, least first.
    fn pairs(&self, seed: usize) -> Vec<(f64, Vec<usize>)> {
        let cosines = self.gram.column(seed).iter().enumerate();
        let others = cosines.filter(|(j, _)| *j != seed);
        let mut all: Vec<(f64, usize)> = others.map(|(j, g)| (1.0 - g * g, j)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let named = all.into_iter().take(BEAM.max(KEPT));
        named.map(|(left, j)| (left, vec![seed, j])).collect()
    }

    /// What each two others leave of the seed, squared, the least ones.
    fn triples(&self, seed: usize) -> Vec<(f64, Vec<usize>)> {
        let n = self.gram.len();
        if n > TRIPLES {
            return self.grow(
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
        let mut bar = f64::INFINITY;
        for j in (0..n).filter(|j| *j != seed) {
            let (a, with) = (own[j], self.gram.column(j));
            for k in 0..j {
                let (b, c) = (own[k], with[k]);
                let room = 1.0 - c * c;
                if k == seed || room < 1e-12 {
                    continue;
                }
                let left = 1.0 - (a * a + b * b - 2.0 * a * b * c) / room;
                if left < bar {
                    best.push((left.max(0.0), k, j));
                    if best.len() > 8 * BEAM {
                        best.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
                        best.truncate(BEAM);
                        bar = best.last().map_or(bar, |b| b.0);
                    }
                }
            }
        }
        best.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        best.truncate(BEAM);
        let named = best
            .into_iter()
            .map(|(left, k, j)| (left, vec![seed, k, j]));
        named.collect()
    }

    /// Sets with one more column: what their others leave of the seed, squared, the least ones.
    fn grow(&self, seed: usize, sets: &[Vec<usize>]) -> Vec<(f64, Vec<usize>)> {
        let mut seen = BTreeSet::new();
        let mut all: Vec<(f64, Vec<usize>)> = Vec::new();
        for set in sets {
            let Some(beside) = Beside::new(self.gram, seed, set) else {
                continue;
            };
            for j in (0..self.gram.len()).filter(|j| !set.contains(j)) {
                let Some(left) = beside.left_with(j) else {
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
            if out.len() >= BEAM.max(KEPT) {
                break;
            }
        }
        out
    }
}

/// Columns of a set without the seed, as a triangle of their cosines.
struct Beside<'a> {
    gram: &'a Gram,
    /// The set without the seed.
    others: Vec<usize>,
    /// Rows of L with L Lᵀ their cosines.
    lower: Vec<Vec<f64>>,
    /// L⁻¹ of the cosines with the seed.
    along: Vec<f64>,
    seed: usize,
}

impl<'a> Beside<'a> {
    fn new(gram: &'a Gram, seed: usize, set: &[usize]) -> Option<Self> {
        let mut beside = Beside {
            gram,
            others: Vec::new(),
            lower: Vec::new(),
            along: Vec::new(),
            seed,
        };
        for j in set.iter().filter(|j| **j != seed) {
            let row = beside.forward(*j);
            let room = 1.0 - row.iter().map(|x| x * x).sum::<f64>();
            if room < 1e-13 {
                return None;
            }
            let known: f64 = row.iter().zip(&beside.along).map(|(a, b)| a * b).sum();
            let pivot = room.sqrt();
            beside.along.push((gram.at(*j, seed) - known) / pivot);
            beside.others.push(*j);
            beside.lower.push([row, vec![pivot]].concat());
        }
        Some(beside)
    }

    /// L⁻¹ of the cosines with column j.
    fn forward(&self, j: usize) -> Vec<f64> {
        let mut out: Vec<f64> = Vec::with_capacity(self.others.len());
        for (row, place) in self.lower.iter().zip(&self.others) {
            let known: f64 = row.iter().zip(&out).map(|(a, b)| a * b).sum();
            let pivot = row.last().copied().unwrap_or(1.0);
            out.push((self.gram.at(*place, j) - known) / pivot);
        }
        out
    }

    /// What is left of the seed beside the set and j, squared.
    fn left_with(&self, j: usize) -> Option<f64> {
        let row = self.forward(j);
        let room = 1.0 - row.iter().map(|x| x * x).sum::<f64>();
        if room < 1e-13 {
            return None;
        }
        let known: f64 = row.iter().zip(&self.along).map(|(a, b)| a * b).sum();
        let gain = (self.gram.at(j, self.seed) - known).powi(2) / room;
        let left = 1.0 - self.along.iter().map(|x| x * x).sum::<f64>() - gain;
        Some(left.max(0.0))
    }
}
