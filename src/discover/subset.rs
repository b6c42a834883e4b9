//! Which terms: best-subset search by beam, then single drops, additions and swaps, under an information criterion.
//!
//! In: columns and target, already weighted and reduced to few rows. Out: supports, best first. Works on orthogonalised columns
//! (modified Gram–Schmidt), not on the Gram matrix, so that clean data keep their digits.

use std::collections::BTreeSet;

use crate::lanes::dot;

/// `samples · ln(rss/rows + floor) + terms · per_term`: the smaller the better.
///
/// The extended Bayesian criterion (Chen & Chen, Biometrika 2008), with a noise floor: below the known error of the data,
/// a smaller residual is no evidence.
#[derive(Clone, Copy, Debug)]
pub struct Criterion {
    /// Rows M that the residual sum is over.
    pub rows: f64,
    /// Independent rows: M over the correlation length of the errors.
    pub samples: f64,
    /// Variance of the known error, in squared units of the target.
    pub floor: f64,
    /// Cost of one term.
    pub per_term: f64,
}

impl Criterion {
    /// Criterion for M rows with errors correlated over `correlation` rows, `candidates` terms to choose from.
    pub fn new(rows: usize, correlation: f64, candidates: usize, floor: f64) -> Self {
        let samples = (rows as f64 / correlation).max(2.0);
        Criterion {
            rows: rows as f64,
            samples,
            floor: floor.max(f64::MIN_POSITIVE),
            per_term: samples.ln() + 2.0 * (candidates.max(1) as f64).ln(),
        }
    }

    pub fn value(&self, rss: f64, terms: usize) -> f64 {
        self.samples * (rss / self.rows + self.floor).ln() + self.per_term * terms as f64
    }
}

/// A choice of columns and how well it does.
#[derive(Clone, Debug)]
pub struct Subset {
    /// Column indices, rising.
    pub support: Vec<usize>,
    /// The criterion.
    pub value: f64,
}

/// The problem: unit columns of length n one after another, the target, and the squared length of what reduction cut off the target.
pub struct Search {
    rows: usize,
    columns: Vec<f64>,
    target: Vec<f64>,
    outside: f64,
    criterion: Criterion,
}

/// States kept at each size.
const BEAM: usize = 8;
/// Sizes without improvement after which the beam ends.
const PATIENCE: usize = 4;
/// A unit column shorter than this after projection is dependent on those chosen.
const DEPENDENT: f64 = 1e-9;

/// Columns projected off a chosen set.
#[derive(Clone)]
struct State {
    support: Vec<usize>,
    columns: Vec<f64>,
    residual: Vec<f64>,
}

impl Search {
    /// `columns` are raw, `rows` long each; zero columns are never chosen.
    pub fn new(
        rows: usize,
        mut columns: Vec<f64>,
        target: Vec<f64>,
        outside: f64,
        criterion: Criterion,
    ) -> Self {
        for column in columns.chunks_exact_mut(rows.max(1)) {
            let length = dot(column, column).sqrt();
            if length > 0.0 {
                column.iter_mut().for_each(|x| *x /= length);
            }
        }
        Search {
            rows: rows.max(1),
            columns,
            target,
            outside,
            criterion,
        }
    }

    /// The same search without some columns, whose places stay.
    pub fn without(&self, gone: &BTreeSet<usize>) -> Search {
        let mut columns = self.columns.clone();
        for (j, column) in columns.chunks_exact_mut(self.rows).enumerate() {
            if gone.contains(&j) {
                column.fill(0.0);
            }
        }
        Search {
            columns,
            target: self.target.clone(),
            ..*self
        }
    }

    /// Distinct supports of up to `most` terms, best criterion first; `starts` join the search. The beam is short work and
    /// always runs; the single changes after it end when `go_on` says no.
    pub fn run(
        &self,
        most: usize,
        starts: &[Vec<usize>],
        go_on: &mut dyn FnMut() -> bool,
    ) -> Vec<Subset> {
        let mut found = Found::default();
        found.add(self.subset(&self.start()));
        self.beam(most, &mut found);
        for start in starts {
            let state = self.project(start);
            found.add(self.subset(&state));
        }
        self.improve(most, &mut found, go_on);
        found.sorted()
    }

    fn beam(&self, most: usize, found: &mut Found) {
        let mut states = vec![self.start()];
        let mut best = f64::INFINITY;
        let mut since = 0;
        for _ in 0..most.min(self.count()) {
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
            if since >= PATIENCE {
                return;
            }
        }
    }

    /// The best supports with one more term than `states`.
    fn grow(&self, states: &[State]) -> Vec<State> {
        let mut moves: Vec<(f64, usize, usize)> = Vec::new();
        for (i, state) in states.iter().enumerate() {
            let rss = dot(&state.residual, &state.residual);
            let mut gains = self.gains(state);
            gains.sort_by(|a, b| b.0.total_cmp(&a.0));
            moves.extend(gains.iter().take(BEAM).map(|(g, j)| (rss - g, i, *j)));
        }
        moves.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut seen = BTreeSet::new();
        let mut next = Vec::new();
        for (_, i, j) in moves {
            let mut support = states[i].support.clone();
            support.push(j);
            support.sort_unstable();
            if seen.insert(support) {
                next.push(self.with(&states[i], j));
            }
            if next.len() == BEAM {
                break;
            }
        }
        next
    }

    /// Follows the best single change until none helps.
    fn improve(&self, most: usize, found: &mut Found, go_on: &mut dyn FnMut() -> bool) {
        let Some(mut best) = found.best().cloned() else {
            return;
        };
        loop {
            let before = best.value;
            let neighbours = self.neighbours(&best.support, most, go_on);
            for n in neighbours {
                if n.value < best.value {
                    best = n.clone();
                }
                found.add(n);
            }
            if best.value >= before - 1e-9 * before.abs() {
                return;
            }
        }
    }

    /// Supports that differ by one term: for each place emptied (or none), the drop and the best fillings.
    fn neighbours(
        &self,
        support: &[usize],
        most: usize,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Vec<Subset> {
        let mut out = Vec::new();
        for gap in 0..=support.len() {
            if !go_on() {
                break;
            }
            let kept: Vec<usize> = support
                .iter()
                .enumerate()
                .filter(|(i, _)| *i != gap)
                .map(|(_, j)| *j)
                .collect();
            let state = self.project(&kept);
            out.push(self.subset(&state));
            if kept.len() >= most {
                continue;
            }
            let mut gains = self.gains(&state);
            gains.sort_by(|a, b| b.0.total_cmp(&a.0));
            for (_, j) in gains.iter().take(3) {
                out.push(self.subset(&self.with(&state, *j)));
            }
        }
        out
    }

    fn count(&self) -> usize {
        self.columns.len() / self.rows
    }

    fn start(&self) -> State {
        State {
            support: Vec::new(),
            columns: self.columns.clone(),
            residual: self.target.clone(),
        }
    }

    fn project(&self, support: &[usize]) -> State {
        support
            .iter()
            .fold(self.start(), |state, j| self.with(&state, *j))
    }

    /// What each column not chosen yet would take off the squared residual.
    fn gains(&self, state: &State) -> Vec<(f64, usize)> {
        state
            .columns
            .chunks_exact(self.rows)
            .enumerate()
            .filter(|(j, _)| !state.support.contains(j))
            .filter_map(|(j, c)| {
                let square = dot(c, c);
                let along = dot(c, &state.residual);
                (square > DEPENDENT * DEPENDENT).then(|| (along * along / square, j))
            })
            .collect()
    }

    /// The state with column `j` chosen: everything else projected off it.
    fn with(&self, state: &State, j: usize) -> State {
        let mut next = state.clone();
        next.support.push(j);
        next.support.sort_unstable();
        let mut direction = state.columns[j * self.rows..(j + 1) * self.rows].to_vec();
        let length = dot(&direction, &direction).sqrt();
        if length <= DEPENDENT {
            return next;
        }
        direction.iter_mut().for_each(|x| *x /= length);
        for column in next.columns.chunks_exact_mut(self.rows) {
            project_off(column, &direction);
        }
        project_off(&mut next.residual, &direction);
        next
    }

    fn subset(&self, state: &State) -> Subset {
        let rss = dot(&state.residual, &state.residual) + self.outside;
        Subset {
            support: state.support.clone(),
            value: self.criterion.value(rss, state.support.len()),
        }
    }
}

/// Supports met so far.
#[derive(Default)]
struct Found {
    seen: BTreeSet<Vec<usize>>,
    subsets: Vec<Subset>,
}

impl Found {
    fn add(&mut self, s: Subset) -> f64 {
        let value = s.value;
        if self.seen.insert(s.support.clone()) {
            self.subsets.push(s);
        }
        value
    }

    fn best(&self) -> Option<&Subset> {
        self.subsets
            .iter()
            .min_by(|a, b| a.value.total_cmp(&b.value))
    }

    fn sorted(mut self) -> Vec<Subset> {
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
    use crate::numbers::Numbers;

    #[test]
    fn planted_supports_are_found_in_noise() {
        let (rows, count) = (120, 40);
        let columns = Numbers(3).many(rows * count);
        let error = Numbers(5).many(rows);
        let column = |j: usize| &columns[j * rows..(j + 1) * rows];
        let target: Vec<f64> = (0..rows)
            .map(|i| 2.0 * column(7)[i] - 0.5 * column(19)[i] + 0.1 * error[i])
            .collect();
        let criterion = Criterion::new(rows, 1.0, count, 0.0);
        let best =
            &Search::new(rows, columns.clone(), target, 0.0, criterion).run(10, &[], &mut || true)
                [0];
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
            let criterion = Criterion::new(rows, 1.0, count, floor * floor);
            let search = Search::new(rows, columns.clone(), target.clone(), 0.0, criterion);
            search.run(10, &[], &mut || true)[0].support.clone()
        };
        assert_eq!(run(1e-4), vec![2]);
        assert_eq!(run(1e-9), vec![2, 5]);
    }

    #[test]
    fn duplicated_columns_are_chosen_once() {
        let rows = 30;
        let one = Numbers(9).many(rows);
        let columns = [one.clone(), one.clone(), Numbers(10).many(rows)].concat();
        let criterion = Criterion::new(rows, 1.0, 3, 1e-20);
        let best = &Search::new(rows, columns, one, 0.0, criterion).run(3, &[], &mut || true)[0];
        assert_eq!(best.support.len(), 1);
    }
}
