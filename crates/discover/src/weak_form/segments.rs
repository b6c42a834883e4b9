//! Uninterrupted segments of the records, with every signal at the quadrature nodes between samples.
//!
//! In: a dataset and the sources of signals. Out: for each segment the noisy records with their first guess, and [`Samples`] of all signals
//! at the nodes. No segment crosses a gap, a missing value or the end of a trajectory. Jumps of held inputs may lie inside: each
//! interval has its own value.

use sidc_data as data;
use sidc_data::{Column, Dataset, Origin, Samples, Trajectory};
use sidc_lang::model::Model;
use sidc_lang::term::Signal;

use super::interpolation::Stencil;
use super::signal_sources::{EquationSignals, SignalSource};
use super::test_functions::GAUSS_NODES;
use super::thresholds::WEAK_FORM;
use super::whittaker_smoother::smooth;

/// One segment of n samples, n − 1 intervals.
#[derive(Clone)]
pub(super) struct Segment {
    /// Seconds; length n.
    pub time: Vec<f64>,
    /// As measured, for each record; length n.
    pub raw: Vec<Vec<f64>>,
    /// The first guess, for each record; length n.
    pub guess: Vec<Vec<f64>>,
    /// All signals at the nodes of every interval; length 3 (n − 1).
    pub nodes: Samples,
}

/// The segments, each of at most `longest` samples, and the standard deviation of each record's noise.
pub(super) fn segments(
    model: &Model,
    dataset: &Dataset,
    sources: &EquationSignals,
    longest: usize,
) -> (Vec<Segment>, Vec<f64>) {
    let mut out = Vec::new();
    let mut squares = vec![(0.0, 0usize); sources.records.len()];
    for (index, trajectory) in dataset.trajectories.iter().enumerate() {
        let time = data::snap_to_even_grid(&trajectory.time);
        for (from, to) in known_ranges(trajectory, sources) {
            let time = &time[from..to];
            let (mut raw, mut guess) = (Vec::new(), Vec::new());
            for (record, square) in sources.records.iter().zip(&mut squares) {
                let y = trajectory.column(*record).unwrap_or_default()[from..to].to_vec();
                let smoothed = smooth(time, &y);
                square.0 += smoothed.noise.powi(2) * y.len() as f64;
                square.1 += y.len();
                raw.push(y);
                guess.push(smoothed.values);
            }
            // Smoothed as one, then cut into pieces of about equal length.
            let pieces = time.len().div_ceil(longest.max(WEAK_FORM.min_segment));
            for k in 0..pieces {
                let cut = |k: usize| k * time.len() / pieces;
                let part = cut(k)..cut(k + 1);
                let of = |all: &[Vec<f64>]| all.iter().map(|v| v[part.clone()].to_vec()).collect();
                let time = &time[part.clone()];
                let mut segment = Segment {
                    time: time.to_vec(),
                    raw: of(&raw),
                    guess: of(&guess),
                    nodes: at_nodes(trajectory, index, from + part.start, time, sources),
                };
                segment.interpolate(sources);
                out.push(segment);
            }
        }
    }
    let seen = |(sum, count): &(f64, usize)| (sum / (*count).max(1) as f64).sqrt();
    let noise = sources.records.iter().zip(&squares);
    let declared = |s: Signal| {
        let columns = dataset.trajectories.iter().filter_map(|t| t.column(s));
        Some(model.noise(s)?.rms(columns.flatten()))
    };
    let noise = noise.map(|(s, q)| declared(*s).unwrap_or_else(|| seen(q)));
    (out, noise.collect())
}

/// Ranges of samples at which every signal is known, cut at gaps, without short ones.
fn known_ranges(trajectory: &Trajectory, sources: &EquationSignals) -> Vec<(usize, usize)> {
    let exact = sources.signals.iter();
    let exact = exact.filter(|(_, r)| matches!(r, SignalSource::Held | SignalSource::Linear));
    let needed: Vec<&[f64]> = (sources.records.iter())
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
            if i >= start + WEAK_FORM.min_segment {
                out.push((start, i));
            }
            start = if ends { i + 1 } else { i };
        }
    }
    out
}

/// Instants of the nodes of every interval.
fn instants(time: &[f64]) -> Vec<f64> {
    let at =
        |w: &[f64]| GAUSS_NODES.map(|(node, _)| 0.5 * (w[0] + w[1]) + 0.5 * node * (w[1] - w[0]));
    time.windows(2).flat_map(at).collect()
}

/// Exactly known signals at the nodes; the others are still zero.
fn at_nodes(
    trajectory: &Trajectory,
    index: usize,
    from: usize,
    time: &[f64],
    sources: &EquationSignals,
) -> Samples {
    let instants = instants(time);
    let column = |(signal, source): &(_, SignalSource)| {
        let exact = |i: usize| trajectory.column(*signal).unwrap_or_default()[from + i];
        let at = |k: usize| {
            let (i, (node, _)) = (k / GAUSS_NODES.len(), GAUSS_NODES[k % GAUSS_NODES.len()]);
            match source {
                SignalSource::Time => instants[k],
                SignalSource::Held => exact(i),
                SignalSource::Linear => {
                    let (a, b) = (exact(i), exact(i + 1));
                    0.5 * (a + b) + 0.5 * node * (b - a)
                }
                SignalSource::Smooth { .. } => 0.0,
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
        columns: sources.signals.iter().map(column).collect(),
        time: instants,
    }
}

impl Segment {
    /// Interpolates the guess of every record to the nodes.
    pub fn interpolate(&mut self, sources: &EquationSignals) {
        for k in 0..self.nodes.len() {
            let stencil = Stencil::new(&self.time, k / GAUSS_NODES.len(), self.nodes.time[k]);
            for (column, (_, source)) in self.nodes.columns.iter_mut().zip(&sources.signals) {
                if let SignalSource::Smooth { record, order } = *source {
                    column.values[k] = stencil.apply(order, &self.guess[record]);
                }
            }
        }
    }
}
