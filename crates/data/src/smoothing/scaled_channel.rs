//! A channel in its own units, and its rows as a chain of nodes for the smoother.
//!
//! In: what [`super::smooth`] was given. Out: a [`ScaledChannel`]. Estimates nothing.

use super::information_smoother::{Node, STATES, Transition};
use super::smoothing_parameter::Channel;
use crate::order_statistics::median_step;
use crate::segmentation::{Break, Segment, segments};
use crate::time_axis::TimeGrid;

/// Spread of a channel of zeros: positive, so that it can be divided by.
const SPREAD_OF_ZEROS: f64 = 1e-280;

/// M values less their mean, over their standard deviation; time in median steps.
pub(super) struct ScaledChannel<'a> {
    pub grid: TimeGrid,
    /// Median step, seconds.
    pub step: f64,
    pub centre: f64,
    pub spread: f64,
    /// 0 where missing.
    pub values: Vec<f64>,
    /// The values as given.
    pub raw: &'a [f64],
    pub missing: Vec<bool>,
    /// Nodes with every break and, if some are jumps of derivatives, nodes with the gaps alone.
    pub break_models: Vec<Vec<Node>>,
    pub segments: Vec<Segment>,
    /// Rows after a gap, rising.
    pub gaps: Vec<usize>,
}

impl<'a> ScaledChannel<'a> {
    pub(super) fn new(time: &[f64], values: &'a [f64], breaks: &[Break]) -> ScaledChannel<'a> {
        let grid = TimeGrid::new(time);
        let step = median_step([grid.time()]).unwrap_or(1.0);
        let missing: Vec<bool> = values.iter().map(|v| !v.is_finite()).collect();
        let raw = values;
        let (centre, spread) = scale(raw);
        let scaled = raw.iter().map(|v| match v.is_finite() {
            true => v / spread - centre / spread,
            false => 0.0,
        });
        let values: Vec<f64> = scaled.collect();
        let gaps: Vec<Break> = breaks.iter().filter(|b| b.order == 0).copied().collect();
        let mut break_models = vec![nodes(grid.time(), step, breaks)];
        if gaps.len() < breaks.len() {
            break_models.push(nodes(grid.time(), step, &gaps));
        }
        ScaledChannel {
            gaps: gaps.iter().map(|b| b.row).collect(),
            raw,
            segments: segments(&missing, breaks),
            grid,
            step,
            centre,
            spread,
            values,
            missing,
            break_models,
        }
    }

    /// Weight 1 for every value that is there, 0 for a missing one.
    pub(super) fn present(&self) -> Vec<f64> {
        let weight = |m: &bool| if *m { 0.0 } else { 1.0 };
        self.missing.iter().map(weight).collect()
    }

    /// The same with weight 0 at the given rows.
    pub(super) fn weights_without(&self, rows: &[usize]) -> Vec<f64> {
        let mut weights = self.present();
        for row in rows {
            if let Some(w) = weights.get_mut(*row) {
                *w = 0.0;
            }
        }
        weights
    }

    pub(super) fn channel<'c>(&'c self, break_model: usize, weights: &'c [f64]) -> Channel<'c> {
        Channel {
            nodes: self
                .break_models
                .get(break_model)
                .map_or(&[], Vec::as_slice),
            values: &self.values,
            weights,
        }
    }

    /// Segments of rows with weight, cut at the breaks too.
    pub(super) fn weighted_segments(&self, weights: &[f64]) -> Vec<Segment> {
        let mut out = Vec::new();
        for s in uninterrupted(weights) {
            let inner = self.segments.iter().map(|c| Segment {
                start: s.start.max(c.start),
                end: s.end.min(c.end),
                rows_end: s.rows_end.min(c.rows_end),
            });
            out.extend(inner.filter(|c| c.start < c.end && c.start < c.rows_end));
        }
        out
    }
}

/// Mean and standard deviation of the finite values; the latter is never 0.
fn scale(values: &[f64]) -> (f64, f64) {
    let finite = || values.iter().filter(|v| v.is_finite());
    let count = finite().count().max(1) as f64;
    let largest = finite().fold(0.0, |m: f64, v| m.max(v.abs()));
    if largest == 0.0 {
        return (0.0, SPREAD_OF_ZEROS);
    }
    // Relative to the largest value, so that no square overflows.
    let mean = finite().map(|v| v / largest).sum::<f64>() / count;
    let variance = finite().map(|v| (v / largest - mean).powi(2)).sum::<f64>() / count;
    let deviation = variance.sqrt().max(f64::EPSILON);
    (mean * largest, deviation * largest)
}

/// Runs of rows with weight, whatever the breaks.
pub(super) fn uninterrupted(weights: &[f64]) -> Vec<Segment> {
    let without: Vec<bool> = weights.iter().map(|w| *w == 0.0).collect();
    segments(&without, &[])
}

/// Rows in order; a row at which only derivatives jump has two nodes.
fn nodes(time: &[f64], step: f64, breaks: &[Break]) -> Vec<Node> {
    let mut out: Vec<Node> = Vec::with_capacity(time.len() + breaks.len());
    let mut breaks = breaks.iter().peekable();
    for (row, t) in time.iter().enumerate() {
        let mut order = STATES;
        while let Some(b) = breaks.next_if(|b| b.row <= row) {
            order = if b.row == row {
                order.min(b.order)
            } else {
                order
            };
        }
        let after = time
            .get(row + 1)
            .map(|n| Transition::Propagate((n - t) / step));
        let next = after.unwrap_or(Transition::Reset(0));
        if order == 0 {
            if let Some(before) = out.last_mut() {
                before.next = Transition::Reset(0);
            }
        } else if order < STATES {
            let next = Transition::Reset(order);
            out.push(Node {
                row,
                uses_reading: true,
                next,
            });
        }
        let uses_reading = order == 0 || order >= STATES;
        out.push(Node {
            row,
            uses_reading,
            next,
        });
    }
    out
}
