//! The linear model with the same state, fitted by least squares to the data used: what a law has to be better than.
//!
//! In: states along the data used, inputs. Out: the state some rows after a start. Rows are cut into steps of an eighth of the horizon,
//! in each of which the inputs count by their mean: x = A x + B u + c over one step. In discrete time a step is one row, and samples
//! before it that the equations read take part. Knows no equations.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::horizon::row_ahead;
use super::state_estimation::StateEstimator;
use super::thresholds::LINEAR_MODEL;
use super::window_choice::{Trial, mean_square, median_score};
use sidc_lang::term::Signal;
use sidc_progress::Observer;

/// Sums of the inputs before each row.
pub(super) struct InputSums(Vec<Vec<f64>>);

impl InputSums {
    pub fn of(estimator: &StateEstimator) -> InputSums {
        let rows = estimator.runs.record().len();
        let mut sums: Vec<Vec<f64>> = Vec::with_capacity(rows + 1);
        sums.push(vec![0.0; estimator.runs.inputs(0).len()]);
        for row in 0..rows {
            let now = estimator.runs.inputs(row);
            let last = sums.last().into_iter().flatten();
            sums.push(last.zip(now).map(|(s, u)| s + u).collect());
        }
        InputSums(sums)
    }

    fn mean(&self, from: usize, to: usize) -> Option<Vec<f64>> {
        let ends = self.0.get(from)?.iter().zip(self.0.get(to)?);
        Some(ends.map(|(a, b)| (b - a) / (to - from) as f64).collect())
    }
}

/// A record that the model is fitted to or predicts.
#[derive(Clone, Copy)]
pub(super) struct Along<'a> {
    pub estimator: &'a StateEstimator<'a>,
    pub inputs: &'a InputSums,
}

pub(super) struct LinearModel<'a> {
    used: Vec<Along<'a>>,
    /// Rows of one step.
    step: usize,
    /// Matrices by the rows of their step; `None` where too few pairs are so far apart.
    maps: BTreeMap<usize, Option<DMatrix<f64>>>,
    /// Whether its starts are the readings themselves, and not the states that the equations were fitted to.
    from_readings: bool,
}

impl<'a> LinearModel<'a> {
    pub fn new(used: Vec<Along<'a>>, horizon_rows: usize) -> LinearModel<'a> {
        let lags = used.iter().any(|u| !u.estimator.runs.history().is_empty());
        LinearModel {
            used,
            step: match lags {
                true => 1,
                false => (horizon_rows / LINEAR_MODEL.steps).max(1),
            },
            maps: BTreeMap::new(),
            from_readings: false,
        }
    }

    /// Chooses between two kinds of starts by the prediction error on the data used: readings, or states fitted with the equations. The
    /// latter have less noise, but are wrong where the equations are.
    pub fn choose_start(
        &mut self,
        trial: &Trial,
        inputs: &[InputSums],
        fitted_rows: usize,
        observer: &mut dyn Observer,
    ) {
        let mut score = |from_readings: bool| {
            self.from_readings = from_readings;
            median_score(trial, |s| {
                let estimator = trial.estimators.get(s.record)?;
                let row = row_ahead(
                    &estimator.runs.record().time,
                    s.row,
                    trial.ahead,
                    trial.step,
                )?;
                let fitted = estimator.state(s.row, fitted_rows, observer).ok();
                let inputs = inputs.get(s.record)?;
                let on = Along { estimator, inputs };
                let end = self
                    .start(on, s.row, fitted.as_ref())
                    .and_then(|x| self.ahead(on, s.row, &x, &[row - s.row]))
                    .and_then(|mut all| all.pop());
                match end {
                    Some(end) => mean_square(trial, estimator, row, &end),
                    None => Some(f64::INFINITY),
                }
            })
        };
        let fitted = score(false);
        let read = score(true);
        self.from_readings = read < fitted;
    }

    /// The state at a row from which predictions start.
    pub fn start(&self, on: Along, row: usize, fitted: Option<&Vec<f64>>) -> Option<Vec<f64>> {
        let before = 2 * LINEAR_MODEL.slope_rows;
        match fitted.filter(|_| !self.from_readings) {
            Some(fitted) => Some(fitted.clone()),
            None => on
                .estimator
                .smoothed(row, row.saturating_sub(before)..row + 1),
        }
    }

    /// The state at each of these rows after the start, in rising order; `None` if no model can be fitted.
    pub fn ahead(
        &mut self,
        on: Along,
        row: usize,
        x: &[f64],
        rows: &[usize],
    ) -> Option<Vec<Vec<f64>>> {
        let mut seen = vec![x.to_vec()];
        let mut out = Vec::new();
        for wanted in rows {
            while seen.len() * self.step <= *wanted {
                let next = self.advance(on, row, &seen, self.step)?;
                seen.push(next);
            }
            let whole = wanted / self.step;
            let rest = wanted % self.step;
            seen.truncate(whole + 1);
            out.push(match rest {
                0 => seen.last()?.clone(),
                rest => self.advance(on, row, &seen, rest)?,
            });
        }
        Some(out)
    }

    /// The state `rows` behind the last one seen.
    fn advance(
        &mut self,
        on: Along,
        start: usize,
        seen: &[Vec<f64>],
        rows: usize,
    ) -> Option<Vec<f64>> {
        let row = start + (seen.len() - 1) * self.step;
        let past = |s: &Signal, at: usize| -> Option<f64> {
            let runs = on.estimator.runs;
            let place = runs.state().iter().position(|x| *x == Signal::new(s.var));
            let predicted = at.checked_sub(start).and_then(|k| seen.get(k));
            match place.zip(predicted) {
                Some((place, x)) => x.get(place).copied(),
                None => runs.record().column(Signal::new(s.var))?.get(at).copied(),
            }
        };
        let regressors = regressors(on, row, seen.last()?, rows, past)?;
        let map = self.map(rows)?;
        let next = map.transpose() * DVector::from_vec(regressors);
        Some(next.iter().copied().collect())
    }

    fn map(&mut self, rows: usize) -> Option<&DMatrix<f64>> {
        if !self.maps.contains_key(&rows) {
            let fitted = fit(&self.used, rows);
            self.maps.insert(rows, fitted);
        }
        self.maps.get(&rows)?.as_ref()
    }
}

/// 1, state, mean inputs until the end of the step, samples before.
fn regressors(
    on: Along,
    row: usize,
    x: &[f64],
    rows: usize,
    past: impl Fn(&Signal, usize) -> Option<f64>,
) -> Option<Vec<f64>> {
    let mut out = vec![1.0];
    out.extend(x);
    out.extend(on.inputs.mean(row, row + rows)?);
    for s in on.estimator.runs.history() {
        out.push(past(s, row.checked_sub(s.shift.unsigned_abs() as usize)?)?);
    }
    out.iter().all(|v| v.is_finite()).then_some(out)
}

/// Least squares over pairs of rows so far apart: one column for each component of the state.
fn fit(used: &[Along], rows: usize) -> Option<DMatrix<f64>> {
    let all: usize = used.iter().map(|u| u.estimator.runs.record().len()).sum();
    let every = all.div_ceil(LINEAR_MODEL.pairs).max(1);
    let around = LINEAR_MODEL.slope_rows;
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for on in used {
        let runs = on.estimator.runs;
        let past =
            |s: &Signal, at: usize| runs.record().column(Signal::new(s.var))?.get(at).copied();
        for range in runs.contiguous() {
            for row in range
                .clone()
                .step_by(every)
                .take_while(|r| r + rows < range.end)
            {
                let pair = || {
                    let smoothed = |row: usize| {
                        let rows = row.saturating_sub(around)..row + around + 1;
                        on.estimator.smoothed(row, rows)
                    };
                    let (x, next) = (smoothed(row)?, smoothed(row + rows)?);
                    Some((regressors(*on, row, &x, rows, past)?, next))
                };
                if let Some((regressors, next)) = pair() {
                    left.push(regressors);
                    right.push(next);
                }
            }
        }
    }
    let columns = left.first()?.len();
    match left.len() < 2 * columns {
        true => None,
        false => ridge_regression(&stacked(&left), &stacked(&right)),
    }
}

fn stacked(rows: &[Vec<f64>]) -> DMatrix<f64> {
    let columns = rows.first().map_or(0, Vec::len);
    DMatrix::from_row_iterator(rows.len(), columns, rows.iter().flatten().copied())
}

/// X that minimises ‖A X − B‖² and a little of ‖X‖², by QR: products of A with itself would lose half of the digits.
fn ridge_regression(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (m, n) = a.shape();
    let size = |norm: f64| if norm > 0.0 { norm } else { 1.0 };
    let sizes: Vec<f64> = a.column_iter().map(|c| size(c.norm())).collect();
    let mut augmented = a.clone().resize_vertically(m + n, 0.0);
    for (j, size) in sizes.iter().enumerate() {
        augmented.column_mut(j).scale_mut(1.0 / size);
        augmented[(m + j, j)] = LINEAR_MODEL.ridge.sqrt();
    }
    let qr = augmented.qr();
    let mut right = b.clone().resize_vertically(m + n, 0.0);
    qr.q_tr_mul(&mut right);
    let mut solved = qr.r().solve_upper_triangular(&right.rows(0, n))?;
    for (mut row, size) in solved.row_iter_mut().zip(sizes) {
        row /= size;
    }
    solved.iter().all(|v| v.is_finite()).then_some(solved)
}
