//! What noise on the records does to the rows, to first order.
//!
//! In: a stretch, its windows, terms with coefficients. Out: for each window the weight of every sample of every record in its
//! residual; the covariance of rows from these.

use crate::dictionary::evaluate;
use crate::term::{Expr, Term};

use super::banded::Banded;
use super::route::{Route, Routes};
use super::splines::{MIDDLE, NODES, Window};
use super::stretch::Stretch;

/// ∂(Σ a φ)/∂(signal) at the middle of each interval: the record, the order of derivative, the values.
pub(super) struct Sensitivity {
    record: usize,
    order: usize,
    values: Vec<f64>,
}

/// Sensitivities to every smoothed signal that the terms mention; one that is not finite somewhere (√x at 0) is left out.
pub(super) fn sensitivities(
    stretch: &Stretch,
    routes: &Routes,
    terms: &[(f64, Term)],
) -> Vec<Sensitivity> {
    let middles: Vec<usize> = (0..stretch.time.len() - 1)
        .map(|i| i * NODES.len() + MIDDLE)
        .collect();
    let at = stretch.nodes.select(&middles);
    let mut out = Vec::new();
    for (signal, route) in &routes.signals {
        let Route::Smooth { record, order } = *route else {
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

/// Weights of samples in one row, for each record, from sample `first` on.
pub(super) struct Influence {
    pub first: usize,
    pub weights: Vec<Vec<f64>>,
}

impl Influence {
    /// Of the right side alone, with its sign: −∫ψ Σ ∂φ/∂x (y − x) dt.
    pub fn of_terms(window: &Window, stretch: &Stretch, all: &[Sensitivity]) -> Influence {
        let n = stretch.time.len();
        let intervals = window.values.len() / NODES.len();
        let first = window.first.saturating_sub(1);
        let end = (window.first + intervals + 2).min(n);
        let mut weights = vec![vec![0.0; end - first]; stretch.raw.len()];
        for s in all {
            let into = &mut weights[s.record];
            // ψ ∂φ/∂x at the middle of interval i; zero off the window.
            let middle = |i: usize| {
                let inside = i.checked_sub(window.first).filter(|k| *k < intervals);
                inside.map_or(0.0, |k| {
                    window.values[k * NODES.len() + MIDDLE] * s.values[i]
                })
            };
            for i in first..end - 1 {
                let h = stretch.time[i + 1] - stretch.time[i];
                let (left, right) = match s.order {
                    0 => (0.5 * h * middle(i), 0.5 * h * middle(i)),
                    1 => (-middle(i), middle(i)),
                    2 => {
                        // By parts: minus the slope of ψ ∂φ/∂ẍ times the slope of the noise.
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

    /// With the left side, the combination of samples that is the target.
    pub fn with_target(mut self, window: &Window, record: usize) -> Influence {
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
    pub fn of_corrections(&self, stretch: &Stretch) -> f64 {
        let records = self.weights.iter().zip(&stretch.raw).zip(&stretch.guess);
        records
            .map(|((weights, raw), guess)| {
                let pairs = raw.iter().zip(guess).skip(self.first);
                let products = weights.iter().zip(pairs).map(|(w, (y, x))| w * (y - x));
                products.sum::<f64>()
            })
            .sum()
    }
}

/// Covariance of the rows: noise of the records, and `slack`, an independent error of every spline between samples.
pub(super) fn covariance(
    rows: &[Influence],
    windows: &[Window],
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
            let mut sum = slack * slack * splines_shared(&windows[i], &windows[j]);
            for ((wa, wb), sigma) in a.weights.iter().zip(&b.weights).zip(noise) {
                sum += sigma * sigma * shared((a.first, wa), (b.first, wb));
            }
            out.add(i, j, sum);
        }
    }
    out
}

fn splines_shared(a: &Window, b: &Window) -> f64 {
    shared((a.first, &a.splines), (b.first, &b.splines))
}

/// Σ of products where two runs of numbers overlap.
fn shared((a_first, a): (usize, &[f64]), (b_first, b): (usize, &[f64])) -> f64 {
    let start = a_first.max(b_first);
    let left = a.iter().skip(start - a_first);
    let right = b.iter().skip(start - b_first);
    left.zip(right).map(|(x, y)| x * y).sum()
}
