//! Best-subset search by a beam, then by single drops, additions and swaps, under an information criterion.
//!
//! In: weighted columns and target, reduced to few rows. Out: supports, best first. Works on columns orthogonalised by modified
//! Gram–Schmidt and never on the Gram matrix, which would lose half of the digits of clean data.

#[cfg(test)]
mod tests;

use sidc_progress::Observer;
use std::collections::BTreeSet;

use crate::selection::information_criterion::InformationCriterion;
use crate::selection::subset_search::{SubsetProblem, descend, extend_beam};
use crate::selection::thresholds::SUBSET_SEARCH;
use sidc_solve::simd::dot;

/// A subset of columns with its criterion.
#[derive(Clone, Debug)]
pub struct ScoredSubset {
    /// Column indices, rising.
    pub support: Vec<usize>,
    /// The criterion.
    pub value: f64,
}

/// The columns and the target that subsets are selected for.
pub struct BestSubsetSearch {
    rows: usize,
    columns: Vec<f64>,
    target: Vec<f64>,
    outside: f64,
    criterion: InformationCriterion,
    /// Columns that every subset has, rising.
    required: Vec<usize>,
}

/// All columns and the target, projected off a chosen subset.
#[derive(Clone)]
struct Projection {
    support: Vec<usize>,
    columns: Vec<f64>,
    residual: Vec<f64>,
}

impl BestSubsetSearch {
    /// `columns` lie one after another, each `rows` long; zero columns are never chosen. `outside` is the squared length of the part
    /// of the target that the reduction to few rows cut off.
    pub fn new(
        rows: usize,
        mut columns: Vec<f64>,
        target: Vec<f64>,
        outside: f64,
        criterion: InformationCriterion,
    ) -> Self {
        for column in columns.chunks_exact_mut(rows.max(1)) {
            let length = dot(column, column).sqrt();
            if length > 0.0 {
                column.iter_mut().for_each(|x| *x /= length);
            }
        }
        BestSubsetSearch {
            rows: rows.max(1),
            columns,
            target,
            outside,
            criterion,
            required: Vec::new(),
        }
    }

    /// The same search among the subsets that have these columns, which rise.
    pub fn requiring(mut self, required: Vec<usize>) -> Self {
        self.required = required;
        self
    }

    /// The same search with some columns set to zero, so that places stay the same.
    pub fn without(&self, gone: &BTreeSet<usize>) -> BestSubsetSearch {
        let mut columns = self.columns.clone();
        for (j, column) in columns.chunks_exact_mut(self.rows).enumerate() {
            if gone.contains(&j) {
                column.fill(0.0);
            }
        }
        BestSubsetSearch {
            columns,
            target: self.target.clone(),
            required: self.required.clone(),
            ..*self
        }
    }

    /// Distinct subsets of up to `max_terms` columns, best criterion first; `starts` join the search. The beam is quick and always
    /// runs; the single changes after it end when the observer says so.
    pub fn run(
        &self,
        max_terms: usize,
        starts: &[Vec<usize>],
        observer: &mut dyn Observer,
    ) -> Vec<ScoredSubset> {
        let max_terms = max_terms.max(self.required.len());
        let mut found = Visited::default();
        found.add(self.subset(&self.start()));
        self.beam(max_terms, &mut found);
        for start in starts {
            let state = self.project(start);
            found.add(self.subset(&state));
        }
        if let Some(best) = found.best().cloned() {
            let mut descent = Descent {
                search: self,
                max_terms,
                visited: &mut found,
            };
            descend(&mut descent, best, usize::MAX, observer);
        }
        found.sorted()
    }

    fn beam(&self, max_terms: usize, found: &mut Visited) {
        let mut states = vec![self.start()];
        let mut best = f64::INFINITY;
        let mut since = 0;
        for _ in self.required.len()..max_terms.min(self.count()) {
            states = self.grow(&states);
            let Some(value) = states
                .iter()
                .map(|s| self.subset(s))
                .map(|s| found.add(s))
                .min_by(f64::total_cmp)
            else {
                return;
            };
            since = if value < best { 0 } else { since + 1 };
            best = best.min(value);
            if since >= SUBSET_SEARCH.beam_patience {
                return;
            }
        }
    }

    /// The best subsets with one more column than those of `states`.
    fn grow(&self, states: &[Projection]) -> Vec<Projection> {
        let mut moves: Vec<(f64, usize, usize)> = Vec::new();
        for (i, state) in states.iter().enumerate() {
            let rss = dot(&state.residual, &state.residual);
            let mut gains = Products::new(self, state).gains(&state.support);
            gains.sort_by(|a, b| b.0.total_cmp(&a.0));
            moves.extend(
                gains
                    .iter()
                    .take(SUBSET_SEARCH.beam_width)
                    .map(|(g, j)| (rss - g, i, *j)),
            );
        }
        moves.sort_by(|a, b| a.0.total_cmp(&b.0));
        extend_beam(
            &moves,
            SUBSET_SEARCH.beam_width,
            |parent| &states[parent].support,
            |parent, column, _| self.with(&states[parent], column),
        )
    }

    /// Subsets one change away: for each column dropped (or none), the subset without it and the best additions to that.
    ///
    /// The columns are projected off the whole support once. Dropping a column j adds back one direction: the part of j orthogonal to the rest
    /// of the support. So all gains after that drop cost one product of each of the N columns with it.
    fn neighbours(
        &self,
        support: &[usize],
        max_terms: usize,
        observer: &mut dyn Observer,
    ) -> Vec<ScoredSubset> {
        let whole = Products::new(self, &self.project(support));
        let mut out = Vec::new();
        for gap in 0..=support.len() {
            if !observer.go_on() {
                break;
            }
            let dropped = support.get(gap).copied();
            if dropped.is_some_and(|j| self.required.contains(&j)) {
                continue;
            }
            let kept: Vec<usize> = (support.iter().copied())
                .filter(|j| Some(*j) != dropped)
                .collect();
            let rest = SupportProjection::new(self, &kept);
            out.push(self.scored(kept.clone(), &rest.residual));
            if kept.len() >= max_terms {
                continue;
            }
            let back = dropped.and_then(|j| rest.direction(self, j));
            let mut gains = match back {
                Some(back) => whole.gains_along(self, &kept, &back, &rest.residual),
                None => whole.gains(&kept),
            };
            gains.sort_by(|a, b| b.0.total_cmp(&a.0));
            for (_, j) in gains.iter().take(SUBSET_SEARCH.additions) {
                let mut larger = kept.clone();
                larger.push(*j);
                larger.sort_unstable();
                out.push(self.scored(larger, &rest.residual_with(self, *j)));
            }
        }
        out
    }

    fn count(&self) -> usize {
        self.columns.len() / self.rows
    }

    /// What is required and nothing else.
    fn start(&self) -> Projection {
        let mut state = Projection {
            support: Vec::new(),
            columns: self.columns.clone(),
            residual: self.target.clone(),
        };
        for j in &self.required {
            self.extend(&mut state, *j);
        }
        state
    }

    /// A support, with what is required.
    fn project(&self, support: &[usize]) -> Projection {
        let mut state = self.start();
        for j in support.iter().filter(|j| !self.required.contains(j)) {
            self.extend(&mut state, *j);
        }
        state
    }

    fn column(&self, j: usize) -> &[f64] {
        &self.columns[j * self.rows..(j + 1) * self.rows]
    }

    /// The state with column `j` chosen too, everything projected off it.
    fn with(&self, state: &Projection, j: usize) -> Projection {
        let mut next = state.clone();
        self.extend(&mut next, j);
        next
    }

    fn extend(&self, state: &mut Projection, j: usize) {
        let place = state.support.partition_point(|k| *k < j);
        state.support.insert(place, j);
        let own = &state.columns[j * self.rows..(j + 1) * self.rows];
        let Some(direction) = unit(own.to_vec()) else {
            return;
        };
        for column in state.columns.chunks_exact_mut(self.rows) {
            project_off(column, &direction);
        }
        project_off(&mut state.residual, &direction);
    }

    fn subset(&self, state: &Projection) -> ScoredSubset {
        self.scored(state.support.clone(), &state.residual)
    }

    fn scored(&self, support: Vec<usize>, residual: &[f64]) -> ScoredSubset {
        let rss = dot(residual, residual) + self.outside;
        ScoredSubset {
            value: self.criterion.value(rss, support.len()),
            support,
        }
    }
}

/// Of each column projected off a subset: its squared length, and its product with the residual.
struct Products {
    of: Vec<(f64, f64)>,
}

impl Products {
    fn new(search: &BestSubsetSearch, state: &Projection) -> Products {
        let columns = state.columns.chunks_exact(search.rows);
        let of = columns.map(|c| (dot(c, c), dot(c, &state.residual)));
        Products { of: of.collect() }
    }

    /// By how much each column not chosen yet would lower the squared residual.
    fn gains(&self, chosen: &[usize]) -> Vec<(f64, usize)> {
        let columns = self.of.iter().enumerate();
        let free = columns.filter(|(j, _)| !chosen.contains(j));
        free.filter_map(|(j, (square, along))| Some((gain(*square, *along)?, j)))
            .collect()
    }

    /// The same beside `kept`, which lacks one column of the subset; `back` is the direction that this leaves, `residual` that of `kept`.
    fn gains_along(
        &self,
        search: &BestSubsetSearch,
        kept: &[usize],
        back: &[f64],
        residual: &[f64],
    ) -> Vec<(f64, usize)> {
        let target = dot(back, residual);
        let columns = self.of.iter().enumerate();
        let free = columns.filter(|(j, _)| !kept.contains(j));
        let gains = free.filter_map(|(j, (square, along))| {
            let part = dot(back, search.column(j));
            Some((gain(square + part * part, along + part * target)?, j))
        });
        gains.collect()
    }
}

/// The target projected off a support, without the columns of other terms. As there, each direction is projected off once, so that a subset
/// has the same criterion however it is reached (`crate::scaled_design::OrthonormalBasis` projects twice).
struct SupportProjection {
    directions: Vec<Vec<f64>>,
    residual: Vec<f64>,
}

impl SupportProjection {
    fn new(search: &BestSubsetSearch, support: &[usize]) -> SupportProjection {
        let mut projection = SupportProjection {
            directions: Vec::new(),
            residual: search.target.clone(),
        };
        // What is required comes first, as in projections of all columns.
        let (required, others): (Vec<usize>, Vec<usize>) =
            support.iter().partition(|j| search.required.contains(j));
        for j in required.into_iter().chain(others) {
            if let Some(direction) = projection.direction(search, j) {
                project_off(&mut projection.residual, &direction);
                projection.directions.push(direction);
            }
        }
        projection
    }

    /// The direction that a column adds; `None` if it adds none.
    fn direction(&self, search: &BestSubsetSearch, j: usize) -> Option<Vec<f64>> {
        let mut column = search.column(j).to_vec();
        for direction in &self.directions {
            project_off(&mut column, direction);
        }
        unit(column)
    }

    /// The residual with column `j` too.
    fn residual_with(&self, search: &BestSubsetSearch, j: usize) -> Vec<f64> {
        let mut residual = self.residual.clone();
        if let Some(direction) = self.direction(search, j) {
            project_off(&mut residual, &direction);
        }
        residual
    }
}

/// What a column lowers the squared residual by; `None` if it is dependent on the chosen ones.
fn gain(square: f64, along: f64) -> Option<f64> {
    (square > SUBSET_SEARCH.dependent * SUBSET_SEARCH.dependent).then(|| along * along / square)
}

/// The direction of a column; `None` if too little of it is left.
fn unit(mut column: Vec<f64>) -> Option<Vec<f64>> {
    let length = dot(&column, &column).sqrt();
    if length <= SUBSET_SEARCH.dependent {
        return None;
    }
    column.iter_mut().for_each(|x| *x /= length);
    Some(column)
}

/// The descent by single changes from the best subset of the beam.
struct Descent<'a> {
    search: &'a BestSubsetSearch,
    max_terms: usize,
    visited: &'a mut Visited,
}

impl SubsetProblem for Descent<'_> {
    type Subset = ScoredSubset;

    fn criterion(&self, subset: &ScoredSubset) -> f64 {
        subset.value
    }

    fn neighbours(
        &mut self,
        subset: &ScoredSubset,
        observer: &mut dyn Observer,
    ) -> Vec<ScoredSubset> {
        let search = self.search;
        let neighbours = search.neighbours(&subset.support, self.max_terms, observer);
        for neighbour in &neighbours {
            self.visited.add(neighbour.clone());
        }
        neighbours
    }
}

/// Subsets met so far.
#[derive(Default)]
struct Visited {
    seen: BTreeSet<Vec<usize>>,
    subsets: Vec<ScoredSubset>,
}

impl Visited {
    fn add(&mut self, s: ScoredSubset) -> f64 {
        let value = s.value;
        if self.seen.insert(s.support.clone()) {
            self.subsets.push(s);
        }
        value
    }

    fn best(&self) -> Option<&ScoredSubset> {
        self.subsets
            .iter()
            .min_by(|a, b| a.value.total_cmp(&b.value))
    }

    fn sorted(mut self) -> Vec<ScoredSubset> {
        self.subsets.sort_by(|a, b| a.value.total_cmp(&b.value));
        self.subsets
    }
}

fn project_off(column: &mut [f64], direction: &[f64]) {
    let along = dot(column, direction);
    column
        .iter_mut()
        .zip(direction)
        .for_each(|(c, d)| *c -= along * d);
}
