//! Whether a column is driven from outside the system, or is a combination of other columns.
//!
//! In: columns of one table. Out: those that are inputs by their values, and those that are combinations of others. Looks at no names.
//!
//! A state has inertia: its own past and that of the others explain where it goes. A column that neither explains, and that moves another,
//! is an input (Granger, Econometrica 37, 1969). An input that repeats itself, such as a sine, looks like a state, and is left one.

use super::law_order::{left_by_least_squares, reach, scaled};
use super::table_column::Column;
use super::thresholds::{EXOGENEITY, LAW_ORDER};

/// Places in `columns` of those that are driven from outside.
pub(super) fn driven_from_outside(columns: &[&Column], time: Option<&Column>) -> Vec<usize> {
    let mut reaches: Vec<usize> = columns.iter().map(|c| reach(&c.values)).collect();
    reaches.sort_unstable();
    let Some(stride) = reaches.get(reaches.len() / 2).copied() else {
        return Vec::new();
    };
    let past = Past::new(columns, time, stride);
    let all = 0..columns.len();
    let alone: Vec<Option<f64>> = all.clone().map(|c| past.unexplained(c, &[])).collect();
    all.filter(|c| past.is_driven(*c, &alone).unwrap_or(false))
        .collect()
}

/// The columns in standard deviations, and the rows k whose samples k − 2s … k + s belong to one run.
struct Past {
    columns: Vec<Vec<f64>>,
    rows: Vec<usize>,
    stride: usize,
}

impl Past {
    fn new(columns: &[&Column], time: Option<&Column>, stride: usize) -> Past {
        let n = columns.iter().map(|c| c.values.len()).min().unwrap_or(0);
        let ordered = |k: &usize| {
            let at = |k: usize| time.map_or(k as f64, |t| t.values[k]);
            at(k + stride) > at(k - 2 * stride)
        };
        let rows: Vec<usize> = (2 * stride..n.saturating_sub(stride))
            .filter(ordered)
            .collect();
        let step = (rows.len() / LAW_ORDER.max_rows).max(1);
        Past {
            columns: columns.iter().map(|c| scaled(&c.values)).collect(),
            rows: rows.into_iter().step_by(step).collect(),
            stride,
        }
    }

    /// Whether a column is an input: neither its own past nor that of others explains its steps, and it helps to explain another column.
    /// `alone`: the part of each column's steps that its own past leaves unexplained. `None` if there are too few rows.
    fn is_driven(&self, column: usize, alone: &[Option<f64>]) -> Option<bool> {
        let own = alone[column]?;
        if own < EXOGENEITY.alone {
            return Some(false);
        }
        let others: Vec<usize> = (0..self.columns.len())
            .filter(|o| *o != column)
            .take(LAW_ORDER.max_signals)
            .collect();
        let with_others = self.unexplained(column, &others)?;
        let moves = |other: &usize| {
            let with = self.unexplained(*other, &[column]);
            with.zip(alone[*other])
                .is_some_and(|(with, without)| with < EXOGENEITY.others * without)
        };
        Some(with_others >= EXOGENEITY.others * own && others.iter().any(moves))
    }

    /// The part of the variance of the column's next step that polynomials in its own past and in the past of `others` leave unexplained.
    fn unexplained(&self, column: usize, others: &[usize]) -> Option<f64> {
        let own = self.columns.get(column)?;
        let (mut rows, mut steps) = (Vec::new(), Vec::new());
        for &k in &self.rows {
            let (now, last, before) = (own[k], own[k - self.stride], own[k - 2 * self.stride]);
            let mut row = vec![
                1.0,
                now,
                last,
                before,
                now * now,
                now * now * now,
                now * last,
            ];
            for other in others.iter().filter_map(|o| self.columns.get(*o)) {
                let at = other[k];
                let earlier = [other[k - self.stride], other[k - 2 * self.stride]];
                row.extend([at, earlier[0], earlier[1], at * at, at * now]);
            }
            let step = own[k + self.stride] - now;
            if step.is_finite() && row.iter().all(|v| v.is_finite()) {
                rows.push(row);
                steps.push(step);
            }
        }
        let wide = rows.first().map_or(0, Vec::len);
        if steps.len() < LAW_ORDER.min_rows + 2 * wide {
            return None;
        }
        let mean = steps.iter().sum::<f64>() / steps.len() as f64;
        let spread = steps.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / steps.len() as f64;
        let free = (steps.len() - wide) as f64;
        Some(left_by_least_squares(&rows, steps)? / free / spread)
    }
}

/// An orthonormal basis of the span of some columns and the constant, on the rows where all columns have numbers.
pub(super) struct Span {
    rows: Vec<usize>,
    basis: Vec<Vec<f64>>,
}

impl Span {
    /// The span of the constant alone. `all`: every column that `has` will be asked for.
    pub fn new(all: &[&Column]) -> Span {
        let n = all.iter().map(|c| c.values.len()).min().unwrap_or(0);
        let step = (n / LAW_ORDER.max_rows).max(1);
        let finite = |k: &usize| all.iter().all(|c| c.values[*k].is_finite());
        let rows: Vec<usize> = (0..n).step_by(step).filter(finite).collect();
        let constant = vec![1.0 / (rows.len().max(1) as f64).sqrt(); rows.len()];
        Span {
            rows,
            basis: vec![constant],
        }
    }

    /// Adds a column. True if it already was in the span on every row, to the digits of a table. False if there are few rows, of which any
    /// column is a combination.
    pub fn add(&mut self, column: &Column) -> bool {
        let own = scaled(&column.values);
        let mut left: Vec<f64> = self.rows.iter().map(|k| own[*k]).collect();
        let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let whole = length(&left);
        // Once more for what rounding left of the first time.
        for q in self.basis.iter().chain(&self.basis) {
            let part: f64 = q.iter().zip(&left).map(|(a, b)| a * b).sum();
            left.iter_mut().zip(q).for_each(|(v, a)| *v -= part * a);
        }
        let rest = length(&left);
        let new = rest > EXOGENEITY.combination * whole;
        if new {
            self.basis.push(left.iter().map(|v| v / rest).collect());
        }
        let enough = self.rows.len() >= EXOGENEITY.rows_a_column * self.basis.len();
        !new && enough && self.basis.len() > 1
    }
}
