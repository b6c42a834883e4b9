//! A channel in its own units, and the chains of nodes that its breaks make of its rows.
//!
//! In: what [`super::smooth`] was given. Out: a [`Record`]. Estimates nothing.

use super::Break;
use super::choose::Channel;
use super::posterior::{Node, STATES, Step};
use crate::data::derivatives::{Grid, Stretch};

/// The spread of a channel of zeros.
const SMALL: f64 = 1e-280;

/// A channel in its own units: values less their mean over their spread, time in median steps.
pub(super) struct Record<'a> {
    pub grid: Grid,
    pub step: f64,
    pub centre: f64,
    pub spread: f64,
    /// 0 where missing.
    pub values: Vec<f64>,
    /// As they came.
    pub raw: &'a [f64],
    pub missing: Vec<bool>,
    /// With every break, and with those of order 0 alone if there are others.
    pub chains: Vec<Vec<Node>>,
    pub stretches: Vec<Stretch>,
    /// Rows that begin after a break of order 0, rising.
    pub torn: Vec<usize>,
}

impl<'a> Record<'a> {
    pub(super) fn new(time: &[f64], values: &'a [f64], breaks: &[Break]) -> Record<'a> {
        let grid = Grid::new(time);
        let mut steps: Vec<f64> = grid.time().windows(2).map(|w| w[1] - w[0]).collect();
        let middle = steps.len() / 2;
        let (_, step, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
        let step = *step;
        let missing: Vec<bool> = values.iter().map(|v| !v.is_finite()).collect();
        let raw = values;
        let (centre, spread) = scale(raw);
        let scaled = raw.iter().map(|v| match v.is_finite() {
            true => v / spread - centre / spread,
            false => 0.0,
        });
        let values: Vec<f64> = scaled.collect();
        let mut chains = vec![chain(grid.time(), step, breaks)];
        if breaks.iter().any(|b| b.order > 0) {
            let gaps: Vec<Break> = breaks.iter().filter(|b| b.order == 0).copied().collect();
            chains.push(chain(grid.time(), step, &gaps));
        }
        let torn = breaks.iter().filter(|b| b.order == 0);
        Record {
            torn: torn.map(|b| b.row).collect(),
            raw,
            stretches: stretches(&missing, breaks),
            grid,
            step,
            centre,
            spread,
            values,
            missing,
            chains,
        }
    }

    pub(super) fn present(&self) -> Vec<f64> {
        let weight = |m: &bool| if *m { 0.0 } else { 1.0 };
        self.missing.iter().map(weight).collect()
    }

    pub(super) fn channel<'c>(&'c self, chain: usize, weights: &'c [f64]) -> Channel<'c> {
        Channel {
            chain: self.chains.get(chain).map_or(&[], Vec::as_slice),
            values: &self.values,
            weights,
        }
    }

    /// Stretches of rows with weight, cut at every break of the record as well.
    pub(super) fn cut(&self, weights: &[f64]) -> Vec<Stretch> {
        let mut out = Vec::new();
        for s in uninterrupted(weights) {
            let inner = self.stretches.iter().map(|c| Stretch {
                start: s.start.max(c.start),
                end: s.end.min(c.end),
                rows_end: s.rows_end.min(c.rows_end),
            });
            out.extend(inner.filter(|c| c.start < c.end && c.start < c.rows_end));
        }
        out
    }
}

/// Mean and standard deviation of the finite values; 1 for the latter if there is none to speak of.
fn scale(values: &[f64]) -> (f64, f64) {
    let finite = || values.iter().filter(|v| v.is_finite());
    let count = finite().count().max(1) as f64;
    let largest = finite().fold(0.0, |m: f64, v| m.max(v.abs()));
    if largest == 0.0 {
        return (0.0, SMALL);
    }
    // Relative to the largest, so that no square leaves the numbers.
    let mean = finite().map(|v| v / largest).sum::<f64>() / count;
    let variance = finite().map(|v| (v / largest - mean).powi(2)).sum::<f64>() / count;
    let deviation = variance.sqrt().max(f64::EPSILON);
    (mean * largest, deviation * largest)
}

/// Stretches of rows with weight.
pub(super) fn uninterrupted(weights: &[f64]) -> Vec<Stretch> {
    let without: Vec<bool> = weights.iter().map(|w| *w == 0.0).collect();
    stretches(&without, &[])
}

/// Rows in order; a row at which only derivatives jump has two nodes.
fn chain(time: &[f64], step: f64, breaks: &[Break]) -> Vec<Node> {
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
        let after = time.get(row + 1).map(|n| Step::Move((n - t) / step));
        let next = after.unwrap_or(Step::Jump(0));
        if order == 0 {
            if let Some(before) = out.last_mut() {
                before.next = Step::Jump(0);
            }
        } else if order < STATES {
            let next = Step::Jump(order);
            out.push(Node {
                row,
                sees: true,
                next,
            });
        }
        let sees = order == 0 || order >= STATES;
        out.push(Node { row, sees, next });
    }
    out
}

/// Uninterrupted rows, cut at breaks; a row at which derivatives jump closes one stretch and opens the next.
pub(super) fn stretches(without: &[bool], breaks: &[Break]) -> Vec<Stretch> {
    let mut out = Vec::new();
    let mut start: Option<usize> = None;
    let mut breaks = breaks.iter().peekable();
    for (row, gone) in without.iter().enumerate() {
        let mut order = None;
        while let Some(b) = breaks.next_if(|b| b.row <= row) {
            order = Some(order.map_or(b.order, |o: usize| o.min(b.order)));
        }
        let close = |start, end| Stretch {
            start,
            end,
            rows_end: row,
        };
        match (start, order) {
            (Some(a), _) if *gone => {
                out.push(close(a, row));
                start = None;
            }
            (Some(a), Some(o)) => {
                out.push(close(a, if o == 0 { row } else { row + 1 }));
                start = Some(row);
            }
            (None, _) if !*gone => start = Some(row),
            _ => {}
        }
    }
    let end = without.len();
    out.extend(start.map(|start| Stretch {
        start,
        end,
        rows_end: end,
    }));
    out
}
