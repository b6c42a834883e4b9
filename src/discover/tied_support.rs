//! Which terms, where constraints tie coefficients: single drops, additions and swaps on all connected equations at once, each
//! support judged by its constrained fit.
//!
//! In: weighted targets, columns to choose among, rows. Out: the best supports with their fit. A term that a constraint ties to
//! a chosen one comes with it, and costs nothing: it is no further freedom.

use std::collections::BTreeMap;

use faer::Mat;
use faer::linalg::solvers::Qr;

use super::subset::Criterion;
use super::support::{MOST_TERMS, TIE};
use crate::dictionary::Dictionary;
use crate::solve::{Fit, FitBlock, Row, Sense, fit};

/// Fillings tried for each place.
const FILLINGS: usize = 5;
/// Rounds of improvement.
const ROUNDS: usize = 60;

/// Columns of each block, rising.
pub(super) type Supports = Vec<Vec<usize>>;

/// A search over the supports of connected equations.
pub(super) struct TiedSearch<'a> {
    pub blocks: Vec<FitBlock>,
    pub criteria: Vec<Criterion>,
    pub rows: &'a [Row],
}

/// The best supports, their fit, and others that the criterion cannot tell from it, block by block.
pub(super) struct Chosen {
    pub supports: Supports,
    pub fit: Fit,
    pub ties: Vec<Supports>,
    /// Columns of each block that took part.
    pub searched: Vec<usize>,
}

/// A support that was fitted; exact zeros are taken off.
#[derive(Clone)]
struct Met {
    supports: Supports,
    value: f64,
    parameters: usize,
}

/// The columns of a pool, rotated to at most as many rows as columns; `residual` is the square that a free fit leaves.
pub(super) fn block(
    dictionary: &dyn Dictionary,
    target: &[f64],
    pool: &[usize],
    weight: f64,
    variance: f64,
) -> FitBlock {
    let columns: Vec<usize> = pool
        .iter()
        .copied()
        .filter(|j| dictionary.norms()[*j] > 0.0)
        .collect();
    let (m, n) = (dictionary.rows(), columns.len());
    let mut all = Mat::zeros(m, n + 1);
    let mut column = vec![0.0; m];
    for (k, &j) in columns.iter().enumerate() {
        dictionary.column(j, &mut column);
        all.col_mut(k)
            .iter_mut()
            .zip(&column)
            .for_each(|(a, c)| *a = *c);
    }
    all.col_mut(n)
        .iter_mut()
        .zip(target)
        .for_each(|(a, y)| *a = *y);
    let mut outside = 0.0;
    if m > n + 1 {
        let qr = Qr::new(all.as_ref());
        let r = qr.thin_R();
        outside = r[(n, n)].powi(2);
        // Below the diagonal the factor holds what it was made with.
        all = Mat::from_fn(n, n + 1, |i, j| if i <= j { r[(i, j)] } else { 0.0 });
    }
    FitBlock {
        columns,
        values: all.subcols(0, n).to_owned(),
        target: all.col(n).iter().copied().collect(),
        outside,
        weight,
        variance,
    }
}

impl TiedSearch<'_> {
    /// The best that is reached from any of the starts; `None` if the rows cannot be obeyed from there.
    pub fn run(&self, starts: &[Supports], go_on: &mut dyn FnMut() -> bool) -> Option<Chosen> {
        let mut seen = BTreeMap::new();
        for start in starts {
            self.improve(self.closed(start.clone()), &mut seen, go_on);
        }
        let met = seen.into_values().flatten();
        let mut met: Vec<Met> = met.collect();
        met.sort_by(|a: &Met, b: &Met| {
            let order = a.value.total_cmp(&b.value);
            order.then_with(|| a.supports.cmp(&b.supports))
        });
        met.dedup_by(|b, a| a.supports == b.supports);
        let best = met.first()?;
        let rivals = met
            .iter()
            .skip(1)
            .filter(|m| m.parameters == best.parameters && m.value < best.value + TIE);
        let mut ties = vec![Vec::new(); self.blocks.len()];
        for rival in rivals {
            for ((own, other), ties) in best.supports.iter().zip(&rival.supports).zip(&mut ties) {
                if own != other && own.len() == other.len() && !ties.contains(other) {
                    ties.push(other.clone());
                }
            }
        }
        Some(Chosen {
            fit: fit(&self.blocks, &best.supports, self.rows)?,
            supports: best.supports.clone(),
            searched: self.blocks.iter().map(|b| b.columns.len()).collect(),
            ties,
        })
    }

    /// Follows the best single change until none helps.
    fn improve(
        &self,
        start: Supports,
        seen: &mut BTreeMap<Supports, Option<Met>>,
        go_on: &mut dyn FnMut() -> bool,
    ) {
        let Some(mut best) = self.judge(start, seen) else {
            return;
        };
        for _ in 0..ROUNDS {
            let before = best.value;
            for supports in self.neighbours(&best.supports) {
                if !go_on() {
                    return;
                }
                if let Some(met) = self.judge(supports, seen)
                    && met.value < best.value
                {
                    best = met;
                }
            }
            if best.value >= before - 1e-9 * before.abs() {
                return;
            }
        }
    }

    fn judge(&self, supports: Supports, seen: &mut BTreeMap<Supports, Option<Met>>) -> Option<Met> {
        if let Some(known) = seen.get(&supports) {
            return known.clone();
        }
        let met = self.fitted(&supports);
        seen.insert(supports, met.clone());
        met
    }

    fn fitted(&self, supports: &Supports) -> Option<Met> {
        let found = fit(&self.blocks, supports, self.rows)?;
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
        // What a block's terms cost, as far as they are free.
        let free = parameters as f64 / terms.max(1) as f64;
        let each = self.criteria.iter().zip(&found.squares).zip(&kept);
        let value = each
            .map(|((c, square), s)| c.value(*square, 0) + free * c.per_term * s.len() as f64)
            .sum();
        Some(Met {
            supports: kept,
            value,
            parameters,
        })
    }

    /// For each place emptied (or none) the drop, and the fillings that follow what is left most closely.
    fn neighbours(&self, supports: &Supports) -> Vec<Supports> {
        let mut places: Vec<Option<(usize, usize)>> = vec![None];
        for (b, s) in supports.iter().enumerate() {
            places.extend(s.iter().map(|j| Some((b, *j))));
        }
        let mut out = Vec::new();
        for place in places {
            let mut kept = supports.clone();
            if let Some((b, j)) = place {
                kept[b].retain(|k| *k != j);
                out.push(kept.clone());
            }
            let Some(found) = fit(&self.blocks, &kept, self.rows) else {
                continue;
            };
            for b in 0..self.blocks.len() {
                if kept[b].len() >= MOST_TERMS {
                    continue;
                }
                for j in self.fillings(b, &kept[b], &found.values[b]) {
                    if Some((b, j)) == place {
                        continue;
                    }
                    let mut filled = kept.clone();
                    insert(&mut filled[b], j);
                    out.push(self.closed(filled));
                }
            }
        }
        out
    }

    /// Columns off the support that correlate most with what is left.
    fn fillings(&self, block: usize, support: &[usize], values: &[f64]) -> Vec<usize> {
        let b = &self.blocks[block];
        let mut rest = b.target.clone();
        for (column, value) in support.iter().zip(values) {
            if let Ok(k) = b.columns.binary_search(column) {
                let c = b.values.col(k);
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
                let c = b.values.col(k);
                let along: f64 = c.iter().zip(&rest).map(|(c, r)| c * r).sum();
                (along.abs() / c.norm_l2(), *j)
            })
            .collect();
        strong.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        strong.into_iter().take(FILLINGS).map(|(_, j)| j).collect()
    }

    /// With every column that an equality ties to a chosen one, and those without which a row cannot be obeyed.
    pub fn closed(&self, mut supports: Supports) -> Supports {
        loop {
            let before = supports.clone();
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

fn insert(support: &mut Vec<usize>, column: usize) {
    if let Err(place) = support.binary_search(&column) {
        support.insert(place, column);
    }
}
