//! Propagation of the records' noise into the rows, to first order.
//!
//! In: a segment, test functions, terms with coefficients. Out: for each row the weight of every sample of every record in its residual,
//! and the covariance of the rows.

use crate::dictionary::evaluate;
use sidc_lang::term::{Expr, Term};

use super::banded_cholesky::Banded;
use super::segments::Segment;
use super::signal_sources::{EquationSignals, SignalSource};
use super::test_functions::{GAUSS_NODES, MIDDLE_NODE, TestFunction};

/// ∂(Σ a φ)/∂(signal) at the middle of each interval; the signal is a derivative of a record.
pub(super) struct Sensitivity {
    record: usize,
    order: usize,
    values: Vec<f64>,
}

/// Sensitivities to every smoothed signal in the terms, without those that are not finite somewhere (√x at 0).
pub(super) fn sensitivities(
    segment: &Segment,
    sources: &EquationSignals,
    terms: &[(f64, Term)],
) -> Vec<Sensitivity> {
    let middles: Vec<usize> = (0..segment.time.len() - 1)
        .map(|i| i * GAUSS_NODES.len() + MIDDLE_NODE)
        .collect();
    let at = segment.nodes.select(&middles);
    let mut out = Vec::new();
    for (signal, source) in &sources.signals {
        let SignalSource::Smooth { record, order } = *source else {
            continue;
        };
        let parts = terms.iter().map(|(a, t)| t.derivative(*signal).scale(*a));
        let slope = parts.fold(Expr::zero(), |sum, part| sum + part);
        let mut values = vec![0.0; middles.len()];
        for (weight, term) in slope.terms() {
            let part = evaluate(term, &at);
            values
                .iter_mut()
                .zip(part)
                .for_each(|(v, p)| *v += weight * p);
        }
        let moves = values.iter().any(|v| *v != 0.0);
        if moves && values.iter().all(|v| v.is_finite()) {
            out.push(Sensitivity {
                record,
                order,
                values,
            });
        }
    }
    out
}

/// Weights of samples in the residual of one row, for each record, from sample `first` on.
pub(super) struct Influence {
    pub first: usize,
    pub weights: Vec<Vec<f64>>,
}

impl Influence {
    /// Those of the right side, with its sign: −∫ψ Σ ∂φ/∂x (y − x) dt.
    pub fn of_terms(window: &TestFunction, segment: &Segment, all: &[Sensitivity]) -> Influence {
        let n = segment.time.len();
        let intervals = window.values.len() / GAUSS_NODES.len();
        let first = window.first.saturating_sub(1);
        let end = (window.first + intervals + 2).min(n);
        let mut weights = vec![vec![0.0; end - first]; segment.raw.len()];
        for s in all {
            let into = &mut weights[s.record];
            // ψ ∂φ/∂x at the middle of interval i; zero off the window.
            let middle = |i: usize| {
                let inside = i.checked_sub(window.first).filter(|k| *k < intervals);
                inside.map_or(0.0, |k| {
                    window.values[k * GAUSS_NODES.len() + MIDDLE_NODE] * s.values[i]
                })
            };
            for i in first..end - 1 {
                let h = segment.time[i + 1] - segment.time[i];
                let (left, right) = match s.order {
                    0 => (0.5 * h * middle(i), 0.5 * h * middle(i)),
                    1 => (-middle(i), middle(i)),
                    2 => {
                        // By parts: −∫ (ψ ∂φ/∂ẍ)′ ẏ dt.
                        let before = if i > 0 { middle(i - 1) } else { 0.0 };
                        let slope = 0.5 * (middle(i + 1) - before) / h;
                        (slope, -slope)
                    }
                    _ => continue,
                };
                into[i - first] -= left;
                into[i + 1 - first] -= right;
            }
        }
        Influence { first, weights }
    }

    /// Adds those of the left side, the target.
    pub fn with_target(mut self, window: &TestFunction, record: usize) -> Influence {
        let into = &mut self.weights[record];
        let at = window.first - self.first;
        let room = into.iter_mut().skip(at);
        room.zip(&window.differences).for_each(|(w, d)| *w += d);
        self
    }

    fn end(&self) -> usize {
        self.first + self.weights.first().map_or(0, Vec::len)
    }

    /// Σ weight · (measured − guess).
    pub fn of_corrections(&self, segment: &Segment) -> f64 {
        let records = self.weights.iter().zip(&segment.raw).zip(&segment.guess);
        records
            .map(|((weights, raw), guess)| {
                let pairs = raw.iter().zip(guess).skip(self.first);
                let products = weights.iter().zip(pairs).map(|(w, (y, x))| w * (y - x));
                products.sum::<f64>()
            })
            .sum()
    }
}

/// Covariance of the rows: noise of the records, and `slack`, an independent error of each B-spline.
pub(super) fn covariance(
    rows: &[Influence],
    windows: &[TestFunction],
    noise: &[f64],
    slack: f64,
) -> Banded {
    let overlap = |i: usize, j: usize| {
        rows[j].end() > rows[i].first
            || windows[j].first + windows[j].splines.len() > windows[i].first
    };
    let mut band = 0;
    for i in 0..rows.len() {
        let first = (0..i).rev().take_while(|j| overlap(i, *j)).last();
        band = band.max(first.map_or(0, |j| i - j));
    }
    let mut out = Banded::zero(rows.len(), band);
    for (i, a) in rows.iter().enumerate() {
        for (j, b) in rows
            .iter()
            .enumerate()
            .take(i + 1)
            .skip(i.saturating_sub(band))
        {
            let mut sum = slack * slack * spline_overlap(&windows[i], &windows[j]);
            for ((wa, wb), sigma) in a.weights.iter().zip(&b.weights).zip(noise) {
                sum += sigma * sigma * overlap_product((a.first, wa), (b.first, wb));
            }
            out.add(i, j, sum);
        }
    }
    out
}

fn spline_overlap(a: &TestFunction, b: &TestFunction) -> f64 {
    overlap_product((a.first, &a.splines), (b.first, &b.splines))
}

/// The inner product of two runs of numbers where they overlap.
fn overlap_product((a_first, a): (usize, &[f64]), (b_first, b): (usize, &[f64])) -> f64 {
    let start = a_first.max(b_first);
    let left = a.iter().skip(start - a_first);
    let right = b.iter().skip(start - b_first);
    left.zip(right).map(|(x, y)| x * y).sum()
}
