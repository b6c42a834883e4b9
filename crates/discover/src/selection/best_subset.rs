//! Best-subset search by a beam, then by single drops, additions and swaps, under an information criterion.
//!
//! In: weighted columns and target, reduced to few rows. Out: supports, best first. Works on columns orthogonalised by modified
//! Gram–Schmidt and never on the Gram matrix, which would lose half of the digits of clean data.

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
            let mut gains = self.gains(state);
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
    fn neighbours(
        &self,
        support: &[usize],
        max_terms: usize,
        observer: &mut dyn Observer,
    ) -> Vec<ScoredSubset> {
        let mut out = Vec::new();
        for gap in 0..=support.len() {
            if !observer.go_on() {
                break;
            }
            if support.get(gap).is_some_and(|j| self.required.contains(j)) {
                continue;
            }
            let kept: Vec<usize> = support
                .iter()
                .enumerate()
                .filter(|(i, _)| *i != gap)
                .map(|(_, j)| *j)
                .collect();
            let state = self.project(&kept);
            out.push(self.subset(&state));
            if kept.len() >= max_terms {
                continue;
            }
            let mut gains = self.gains(&state);
            gains.sort_by(|a, b| b.0.total_cmp(&a.0));
            for (_, j) in gains.iter().take(SUBSET_SEARCH.additions) {
                out.push(self.subset(&self.with(&state, *j)));
            }
        }
        out
    }

    fn count(&self) -> usize {
        self.columns.len() / self.rows
    }

    /// What is required and nothing else.
    fn start(&self) -> Projection {
        let nothing = Projection {
            support: Vec::new(),
            columns: self.columns.clone(),
            residual: self.target.clone(),
        };
        let required = self.required.iter();
        required.fold(nothing, |state, j| self.with(&state, *j))
    }

    /// A support, with what is required.
    fn project(&self, support: &[usize]) -> Projection {
        let new = support.iter().filter(|j| !self.required.contains(j));
        new.fold(self.start(), |state, j| self.with(&state, *j))
    }

    /// By how much each column not chosen yet would lower the squared residual.
    fn gains(&self, state: &Projection) -> Vec<(f64, usize)> {
        state
            .columns
            .chunks_exact(self.rows)
            .enumerate()
            .filter(|(j, _)| !state.support.contains(j))
            .filter_map(|(j, c)| {
                let square = dot(c, c);
                let along = dot(c, &state.residual);
                (square > SUBSET_SEARCH.dependent * SUBSET_SEARCH.dependent)
                    .then(|| (along * along / square, j))
            })
            .collect()
    }

    /// The state with column `j` chosen too, everything projected off it.
    fn with(&self, state: &Projection, j: usize) -> Projection {
        let mut next = state.clone();
        next.support.push(j);
        next.support.sort_unstable();
        let mut direction = state.columns[j * self.rows..(j + 1) * self.rows].to_vec();
        let length = dot(&direction, &direction).sqrt();
        if length <= SUBSET_SEARCH.dependent {
            return next;
        }
        direction.iter_mut().for_each(|x| *x /= length);
        for column in next.columns.chunks_exact_mut(self.rows) {
            project_off(column, &direction);
        }
        project_off(&mut next.residual, &direction);
        next
    }

    fn subset(&self, state: &Projection) -> ScoredSubset {
        let rss = dot(&state.residual, &state.residual) + self.outside;
        ScoredSubset {
            support: state.support.clone(),
            value: self.criterion.value(rss, state.support.len()),
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_progress::Unwatched;
    use sidc_random::Numbers;

    #[test]
    fn planted_supports_are_found_in_noise() {
        let (rows, count) = (120, 40);
        let columns = Numbers(3).many(rows * count);
        let error = Numbers(5).many(rows);
        let column = |j: usize| &columns[j * rows..(j + 1) * rows];
        let target: Vec<f64> = (0..rows)
            .map(|i| 2.0 * column(7)[i] - 0.5 * column(19)[i] + 0.1 * error[i])
            .collect();
        let criterion = InformationCriterion::new(rows, 1.0, count, 0.0);
        let best = &BestSubsetSearch::new(rows, columns.clone(), target, 0.0, criterion).run(
            10,
            &[],
            &mut Unwatched,
        )[0];
        assert_eq!(best.support, vec![7, 19]);
    }

    #[test]
    fn below_the_floor_a_better_fit_is_no_evidence() {
        let (rows, count) = (100, 20);
        let columns = Numbers(11).many(rows * count);
        let column = |j: usize| &columns[j * rows..(j + 1) * rows];
        let target: Vec<f64> = (0..rows)
            .map(|i| column(2)[i] + 1e-6 * column(5)[i])
            .collect();
        let run = |floor: f64| {
            let criterion = InformationCriterion::new(rows, 1.0, count, floor * floor);
            let search =
                BestSubsetSearch::new(rows, columns.clone(), target.clone(), 0.0, criterion);
            search.run(10, &[], &mut Unwatched)[0].support.clone()
        };
        assert_eq!(run(1e-4), vec![2]);
        assert_eq!(run(1e-9), vec![2, 5]);
    }

    #[test]
    fn what_is_required_is_in_every_subset() {
        let (rows, count) = (120, 30);
        let columns = Numbers(3).many(rows * count);
        let error = Numbers(5).many(rows);
        let column = |j: usize| &columns[j * rows..(j + 1) * rows];
        let target: Vec<f64> = (0..rows)
            .map(|i| 2.0 * column(7)[i] - 0.5 * column(19)[i] + 0.1 * error[i])
            .collect();
        let criterion = InformationCriterion::new(rows, 1.0, count, 0.0);
        let search = BestSubsetSearch::new(rows, columns.clone(), target, 0.0, criterion)
            .requiring(vec![4, 19]);
        let found = search.run(10, &[vec![1, 2]], &mut Unwatched);
        assert_eq!(found[0].support, vec![4, 7, 19]);
        for subset in &found {
            assert!(subset.support.contains(&4) && subset.support.contains(&19));
        }
        // More of them than terms are allowed otherwise.
        let all = search.requiring((0..12).collect());
        assert!(all.run(3, &[], &mut Unwatched)[0].support.len() >= 12);
    }

    #[test]
    fn duplicated_columns_are_chosen_once() {
        let rows = 30;
        let one = Numbers(9).many(rows);
        let columns = [one.clone(), one.clone(), Numbers(10).many(rows)].concat();
        let criterion = InformationCriterion::new(rows, 1.0, 3, 1e-20);
        let best =
            &BestSubsetSearch::new(rows, columns, one, 0.0, criterion).run(3, &[], &mut Unwatched)
                [0];
        assert_eq!(best.support.len(), 1);
    }
}
