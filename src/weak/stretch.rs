//! Uninterrupted stretches of the record, each signal known at the nodes between samples.
//!
//! In: a dataset and routes. Out: per stretch the noisy records with their first guess, and [`Samples`] of every signal at the
//! quadrature's nodes. No stretch crosses a gap, a missing value or the end of a trajectory; jumps of held inputs are crossed, each
//! interval with its own value.

use crate::data::{self, Column, Dataset, Origin, Samples, Trajectory};
use crate::lang::model::Model;

use super::curve::{POINTS, Stencil};
use super::route::{Route, Routes};
use super::smooth::smooth;
use super::splines::NODES;

#[derive(Clone)]
/// One stretch of n samples, n − 1 intervals.
pub(super) struct Stretch {
    /// Seconds; length n.
    pub time: Vec<f64>,
    /// As measured, for each record; length n.
    pub raw: Vec<Vec<f64>>,
    /// The first guess, for each record; length n.
    pub guess: Vec<Vec<f64>>,
    /// Every routed signal at the nodes of every interval; length 3 (n − 1).
    pub nodes: Samples,
}

/// Shortest stretch that is used, samples.
const SHORTEST: usize = POINTS + 4;

/// The stretches, each of at most `longest` samples, and the standard deviation of each record's noise.
pub(super) fn stretches(
    model: &Model,
    dataset: &Dataset,
    routes: &Routes,
    longest: usize,
) -> (Vec<Stretch>, Vec<f64>) {
    let mut out = Vec::new();
    let mut squares = vec![(0.0, 0usize); routes.records.len()];
    for (index, trajectory) in dataset.trajectories.iter().enumerate() {
        let time = data::settled(&trajectory.time);
        for (from, to) in whole(trajectory, routes) {
            let time = &time[from..to];
            let (mut raw, mut guess) = (Vec::new(), Vec::new());
            for (record, square) in routes.records.iter().zip(&mut squares) {
                let y = trajectory.column(*record).unwrap_or_default()[from..to].to_vec();
                let smoothed = smooth(time, &y);
                square.0 += smoothed.noise.powi(2) * y.len() as f64;
                square.1 += y.len();
                raw.push(y);
                guess.push(smoothed.values);
            }
            // Pieces of much the same length, smoothed as one.
            let pieces = time.len().div_ceil(longest.max(SHORTEST));
            for k in 0..pieces {
                let cut = |k: usize| k * time.len() / pieces;
                let part = cut(k)..cut(k + 1);
                let of = |all: &[Vec<f64>]| all.iter().map(|v| v[part.clone()].to_vec()).collect();
                let time = &time[part.clone()];
                let mut stretch = Stretch {
                    time: time.to_vec(),
                    raw: of(&raw),
                    guess: of(&guess),
                    nodes: at_nodes(trajectory, index, from + part.start, time, routes),
                };
                stretch.interpolate(routes);
                out.push(stretch);
            }
        }
    }
    let seen = |(sum, count): &(f64, usize)| (sum / (*count).max(1) as f64).sqrt();
    let noise = routes.records.iter().zip(&squares);
    let noise = noise.map(|(s, q)| model.noise(*s).unwrap_or_else(|| seen(q)));
    (out, noise.collect())
}

/// Ranges of samples at which every signal is known, cut at gaps, the shortest left out.
fn whole(trajectory: &Trajectory, routes: &Routes) -> Vec<(usize, usize)> {
    let exact = routes.signals.iter();
    let exact = exact.filter(|(_, r)| matches!(r, Route::Held | Route::Linear));
    let needed: Vec<&[f64]> = (routes.records.iter())
        .chain(exact.map(|(s, _)| s))
        .filter_map(|s| trajectory.column(*s))
        .collect();
    let known = |i: usize| {
        needed
            .iter()
            .all(|v| v.get(i).is_some_and(|x| x.is_finite()))
    };
    let gaps = data::gaps(&trajectory.time);
    let mut out = Vec::new();
    let mut start = 0;
    for i in 0..=trajectory.len() {
        let ends = i == trajectory.len() || !known(i);
        if ends || gaps.binary_search(&i).is_ok() {
            if i >= start + SHORTEST {
                out.push((start, i));
            }
            start = if ends { i + 1 } else { i };
        }
    }
    out
}

/// Instants of the nodes of every interval.
fn instants(time: &[f64]) -> Vec<f64> {
    let at = |w: &[f64]| NODES.map(|(node, _)| 0.5 * (w[0] + w[1]) + 0.5 * node * (w[1] - w[0]));
    time.windows(2).flat_map(at).collect()
}

/// Exactly known signals at the nodes; the others are zero yet.
fn at_nodes(
    trajectory: &Trajectory,
    index: usize,
    from: usize,
    time: &[f64],
    routes: &Routes,
) -> Samples {
    let instants = instants(time);
    let column = |(signal, route): &(_, Route)| {
        let exact = |i: usize| trajectory.column(*signal).unwrap_or_default()[from + i];
        let at = |k: usize| {
            let (i, (node, _)) = (k / NODES.len(), NODES[k % NODES.len()]);
            match route {
                Route::Time => instants[k],
                Route::Held => exact(i),
                Route::Linear => {
                    let (a, b) = (exact(i), exact(i + 1));
                    0.5 * (a + b) + 0.5 * node * (b - a)
                }
                Route::Smooth { .. } => 0.0,
            }
        };
        Column {
            signal: *signal,
            values: (0..instants.len()).map(at).collect(),
            origin: Origin::Measured { noise: None },
        }
    };
    Samples {
        trajectory: vec![index as u32; instants.len()],
        columns: routes.signals.iter().map(column).collect(),
        time: instants,
    }
}

impl Stretch {
    /// Takes the signals of every record at the nodes from its guess.
    pub fn interpolate(&mut self, routes: &Routes) {
        for k in 0..self.nodes.len() {
            let stencil = Stencil::new(&self.time, k / NODES.len(), self.nodes.time[k]);
            for (column, (_, route)) in self.nodes.columns.iter_mut().zip(&routes.signals) {
                if let Route::Smooth { record, order } = *route {
                    column.values[k] = stencil.apply(order, &self.guess[record]);
                }
            }
        }
    }
}
