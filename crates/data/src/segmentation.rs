//! Where a signal is not smooth, and the segments of a record between such places.
//!
//! In: a trajectory's instants and inputs, or a list of [`Break`]s. Out: breaks, as the smoother takes them, and [`Segment`]s,
//! which no window of samples leaves. Looks at no value of the signal.

use sidc_lang::model::Model;
use sidc_lang::term::Signal;

use crate::dataset::{Dataset, Trajectory};
use crate::{intersample, time_axis};

/// From this row on, the derivatives of order `order` and above are unrelated to those before. Order 0 is a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Break {
    pub row: usize,
    pub order: usize,
}

/// Samples `start..end` that a window may span; derivatives are wanted at `start..rows_end`.
///
/// The sample at which an input jumps ends one segment and starts the next; its derivative is that to the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Segment {
    pub start: usize,
    pub end: usize,
    pub rows_end: usize,
}

impl Segment {
    pub(crate) fn len(&self) -> usize {
        self.end - self.start
    }
}

/// Breaks of a measured signal along one trajectory, sorted by row.
///
/// A jump of a held input makes the highest derivative of every variable jump. For a signal measured `d` orders below it, this
/// is its d-th derivative; for an output of order 0 its value.
pub fn breaks(
    model: &Model,
    dataset: &Dataset,
    trajectory: &Trajectory,
    signal: Signal,
) -> Vec<Break> {
    let highest = model.var(signal.var).map_or(1, |v| v.order);
    let order = usize::from(highest.saturating_sub(signal.der));
    let jumps = intersample::jumps(&dataset.inputs, trajectory);
    breaks_at(&time_axis::gaps(&trajectory.time), &jumps, order)
}

/// Gaps and jumps of derivative `order` as one list, sorted by row; of two breaks at one row the gap stays.
pub(crate) fn breaks_at(gaps: &[usize], jumps: &[usize], order: usize) -> Vec<Break> {
    let mut out: Vec<Break> = gaps.iter().map(|&row| Break { row, order: 0 }).collect();
    out.extend(jumps.iter().map(|&row| Break { row, order }));
    out.sort_unstable();
    out.dedup_by_key(|b| b.row);
    out
}

/// Runs of rows that are not missing, cut at breaks.
///
/// A gap separates two segments; a row at which only derivatives jump belongs to both.
pub(crate) fn segments(missing: &[bool], breaks: &[Break]) -> Vec<Segment> {
    let mut out = Vec::new();
    let mut start: Option<usize> = None;
    let mut breaks = breaks.iter().peekable();
    for (row, gone) in missing.iter().enumerate() {
        let mut order = None;
        while let Some(b) = breaks.next_if(|b| b.row <= row) {
            order = Some(order.map_or(b.order, |o: usize| o.min(b.order)));
        }
        let close = |start, end| Segment {
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
    let end = missing.len();
    out.extend(start.map(|start| Segment {
        start,
        end,
        rows_end: end,
    }));
    out
}
