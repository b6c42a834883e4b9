//! Subset selection under constraints: single drops, additions and swaps on all coupled equations at once, each support scored by its
//! constrained fit.
//!
//! In: weighted targets, columns, rows. Out: the best supports with their fit. A term that an equality ties to a chosen one is
//! chosen with it and costs nothing, since it is no further degree of freedom. Never relaxes a row.

use sidc_progress::Observer;
use std::collections::BTreeMap;

use nalgebra::DMatrix;

use crate::constrained::thresholds::CONSTRAINED_SEARCH;
use crate::selection::information_criterion::InformationCriterion;
use crate::selection::qr_reduction::qr_reduction;
use crate::selection::subset_search::{SubsetProblem, descend};
use crate::selection::thresholds::TERM_SELECTION;
use sidc_solve::dictionary::Dictionary;
use sidc_solve::{
    ConstrainedFit, LinearConstraint, RegressionBlock, Sense, constrained_least_squares,
};

/// Columns of each block, rising.
pub(crate) type Supports = Vec<Vec<usize>>;

/// A search over the supports of coupled equations.
pub(crate) struct ConstrainedSearch<'a> {
    pub blocks: Vec<RegressionBlock>,
    pub criteria: Vec<InformationCriterion>,
    pub rows: &'a [LinearConstraint],
    /// Columns of each block that every support has.
    pub required: Supports,
}

/// The best supports with their fit, and those of each block that tie with them.
pub(crate) struct ConstrainedSelection {
    pub supports: Supports,
    pub fit: ConstrainedFit,
    pub ties: Vec<Supports>,
    /// Columns of each block that took part.
    pub searched: Vec<usize>,
}

/// Supports that were fitted, without terms whose coefficient is exactly zero.
#[derive(Clone)]
struct ScoredSupports {
    supports: Supports,
    value: f64,
    parameters: usize,
}

/// The columns of a pool, reduced by QR to at most as many rows as columns. `weight` is the inverse variance of a row, `variance`
/// that of its residual.
pub(crate) fn block(
    dictionary: &dyn Dictionary,
    target: &[f64],
    pool: &[usize],
    weight: f64,
    variance: f64,
) -> RegressionBlock {
    let columns: Vec<usize> = pool
        .iter()
        .copied()
        .filter(|j| dictionary.norm(*j) > 0.0)
        .collect();
    let (m, n) = (dictionary.rows(), columns.len());
    let mut all = DMatrix::zeros(m, n + 1);
    let mut column = vec![0.0; m];
    for (k, &j) in columns.iter().enumerate() {
        dictionary.column(j, &mut column);
        all.column_mut(k).copy_from_slice(&column);
    }
    all.column_mut(n).copy_from_slice(target);
    let (all, outside) = qr_reduction(all);
    RegressionBlock {
        columns,
        values: all.columns(0, n).into_owned(),
        target: all.column(n).iter().copied().collect(),
        outside,
        weight,
        variance,
    }
}

impl ConstrainedSearch<'_> {
    /// The best selection reached from any of the starts; `None` if no start can satisfy the rows.
    pub fn run(
        &self,
        starts: &[Supports],
        observer: &mut dyn Observer,
    ) -> Option<ConstrainedSelection> {
        let mut seen = BTreeMap::new();
        for start in starts {
            let mut descent = Descent {
                search: self,
                scored: &mut seen,
            };
            if let Some(start) = self.score(self.closure(start.clone()), descent.scored) {
                descend(&mut descent, start, CONSTRAINED_SEARCH.max_moves, observer);
            }
        }
        let met = seen.into_values().flatten();
        let mut met: Vec<ScoredSupports> = met.collect();
        met.sort_by(|a: &ScoredSupports, b: &ScoredSupports| {
            let order = a.value.total_cmp(&b.value);
            order.then_with(|| a.supports.cmp(&b.supports))
        });
        met.dedup_by(|b, a| a.supports == b.supports);
        let best = met.first()?;
        let rivals = met.iter().skip(1).filter(|m| {
            m.parameters == best.parameters && m.value < best.value + TERM_SELECTION.tie
        });
        let mut ties = vec![Vec::new(); self.blocks.len()];
        for rival in rivals {
            for ((own, other), ties) in best.supports.iter().zip(&rival.supports).zip(&mut ties) {
                if own != other && own.len() == other.len() && !ties.contains(other) {
                    ties.push(other.clone());
                }
            }
        }
        Some(ConstrainedSelection {
            fit: constrained_least_squares(&self.blocks, &best.supports, self.rows)?,
            supports: best.supports.clone(),
            searched: self.blocks.iter().map(|b| b.columns.len()).collect(),
            ties,
        })
    }

    fn score(
        &self,
        supports: Supports,
        seen: &mut BTreeMap<Supports, Option<ScoredSupports>>,
    ) -> Option<ScoredSupports> {
        if let Some(known) = seen.get(&supports) {
            return known.clone();
        }
        let met = self.fitted(&supports);
        seen.insert(supports, met.clone());
        met
    }

    fn fitted(&self, supports: &Supports) -> Option<ScoredSupports> {
        let found = constrained_least_squares(&self.blocks, supports, self.rows)?;
        let kept: Supports = supports
            .iter()
            .zip(&found.values)
            .map(|(s, v)| {
                let pairs = s.iter().zip(v).filter(|(_, v)| **v != 0.0);
                pairs.map(|(j, _)| *j).collect()
            })
            .collect();
        let terms: usize = kept.iter().map(Vec::len).sum();
        let parameters = found.parameters.min(terms);
        // Tied terms share their cost: only free parameters count.
        let free = parameters as f64 / terms.max(1) as f64;
        let each = self.criteria.iter().zip(&found.squares).zip(&kept);
        let value = each
            .map(|((c, square), s)| c.value(*square, 0) + free * c.per_term * s.len() as f64)
            .sum();
        Some(ScoredSupports {
            supports: kept,
            value,
            parameters,
        })
    }

    /// Supports one change away: for each term dropped (or none), the supports without it and the best additions to those.
    fn neighbours(&self, supports: &Supports) -> Vec<Supports> {
        let mut places: Vec<Option<(usize, usize)>> = vec![None];
        for (b, s) in supports.iter().enumerate() {
            let free = s.iter().filter(|j| !self.required[b].contains(j));
            places.extend(free.map(|j| Some((b, *j))));
        }
        let mut out = Vec::new();
        for place in places {
            let mut kept = supports.clone();
            if let Some((b, j)) = place {
                kept[b].retain(|k| *k != j);
                out.push(kept.clone());
            }
            let Some(found) = constrained_least_squares(&self.blocks, &kept, self.rows) else {
                continue;
            };
            for b in 0..self.blocks.len() {
                if kept[b].len() >= TERM_SELECTION.max_terms {
                    continue;
                }
                for j in self.best_additions(b, &kept[b], &found.values[b]) {
                    if Some((b, j)) == place {
                        continue;
                    }
                    let mut filled = kept.clone();
                    insert(&mut filled[b], j);
                    out.push(self.closure(filled));
                }
            }
        }
        out
    }

    /// The columns off the support that correlate most with the residual.
    fn best_additions(&self, block: usize, support: &[usize], values: &[f64]) -> Vec<usize> {
        let b = &self.blocks[block];
        let mut rest = b.target.clone();
        for (column, value) in support.iter().zip(values) {
            if let Ok(k) = b.columns.binary_search(column) {
                let c = b.values.column(k);
                rest.iter_mut()
                    .zip(c.iter())
                    .for_each(|(r, c)| *r -= value * c);
            }
        }
        let mut strong: Vec<(f64, usize)> = b
            .columns
            .iter()
            .enumerate()
            .filter(|(_, j)| support.binary_search(j).is_err())
            .map(|(k, j)| {
                let c = b.values.column(k);
                let along: f64 = c.iter().zip(&rest).map(|(c, r)| c * r).sum();
                (along.abs() / c.norm(), *j)
            })
            .collect();
        strong.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        strong
            .into_iter()
            .take(CONSTRAINED_SEARCH.additions)
            .map(|(_, j)| j)
            .collect()
    }

    /// The closure of supports: with every column that an equality ties to a chosen one, and those without which a row cannot be
    /// satisfied.
    pub fn closure(&self, mut supports: Supports) -> Supports {
        loop {
            let before = supports.clone();
            for (support, required) in supports.iter_mut().zip(&self.required) {
                required.iter().for_each(|j| insert(support, *j));
            }
            for row in self.rows {
                let chosen =
                    |(b, j, _): &(usize, usize, f64)| supports[*b].binary_search(j).is_ok();
                let needed = match row.sense {
                    Sense::Equal => row.right != 0.0 || row.entries.iter().any(chosen),
                    Sense::AtMost | Sense::Below => row.right < 0.0,
                };
                for (b, j, _) in row.entries.iter().filter(|_| needed) {
                    insert(&mut supports[*b], *j);
                }
            }
            if supports == before {
                return supports;
            }
        }
    }
}

/// The descent by single changes from one start.
struct Descent<'s, 'a> {
    search: &'s ConstrainedSearch<'a>,
    /// Every support that was fitted; `None` where the rows cannot be satisfied.
    scored: &'s mut BTreeMap<Supports, Option<ScoredSupports>>,
}

impl SubsetProblem for Descent<'_, '_> {
    type Subset = ScoredSupports;

    fn criterion(&self, subset: &ScoredSupports) -> f64 {
        subset.value
    }

    fn neighbours(
        &mut self,
        subset: &ScoredSupports,
        observer: &mut dyn Observer,
    ) -> Vec<ScoredSupports> {
        let near = self.search.neighbours(&subset.supports).into_iter();
        let near = near.take_while(|_| observer.go_on());
        near.filter_map(|supports| self.search.score(supports, self.scored))
            .collect()
    }
}

fn insert(support: &mut Vec<usize>, column: usize) {
    if let Err(place) = support.binary_search(&column) {
        support.insert(place, column);
    }
}
