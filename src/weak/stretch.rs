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

/// The stretches, and the standard deviation of each record's noise.
pub(super) fn stretches(
    model: &Model,
    dataset: &Dataset,
    routes: &Routes,
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
            let nodes = at_nodes(trajectory, index, (from, time), routes, &guess);
            out.push(Stretch {
                time: time.to_vec(),
                raw,
                guess,
                nodes,
            });
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

fn at_nodes(
    trajectory: &Trajectory,
    index: usize,
    (from, time): (usize, &[f64]),
    routes: &Routes,
    guess: &[Vec<f64>],
) -> Samples {
    let mut instants = Vec::new();
    let mut stencils = Vec::new();
    for (i, pair) in time.windows(2).enumerate() {
        for (node, _) in NODES {
            let t = 0.5 * (pair[0] + pair[1]) + 0.5 * node * (pair[1] - pair[0]);
            instants.push(t);
            stencils.push(Stencil::new(time, i, t));
        }
    }
    let column = |(signal, route): &(_, Route)| {
        let exact = || &trajectory.column(*signal).unwrap_or_default()[from..];
        let values = match *route {
            Route::Time => instants.clone(),
            Route::Held => (0..instants.len())
                .map(|k| exact()[k / NODES.len()])
                .collect(),
            Route::Linear => (0..instants.len())
                .map(|k| {
                    let (i, (node, _)) = (k / NODES.len(), NODES[k % NODES.len()]);
                    let (a, b) = (exact()[i], exact()[i + 1]);
                    0.5 * (a + b) + 0.5 * node * (b - a)
                })
                .collect(),
            Route::Smooth { record, order } => stencils
                .iter()
                .map(|s| s.apply(order, &guess[record]))
                .collect(),
        };
        Column {
            signal: *signal,
            values,
            origin: Origin::Measured { noise: None },
        }
    };
    Samples {
        trajectory: vec![index as u32; instants.len()],
        columns: routes.signals.iter().map(column).collect(),
        time: instants,
    }
}
