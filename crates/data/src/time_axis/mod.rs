//! Sampling instants: their steps, gaps and numbers, and the even grid that they were rounded from.
//!
//! In: the times of one trajectory. Out: statistics, ranges of rows, repaired times. Reports nothing itself.

mod even_grid;
pub(crate) mod thresholds;

pub use even_grid::snap_to_even_grid;
pub(crate) use even_grid::{TimeGrid, even_grid};
use thresholds::TIME_AXIS;

use crate::series::rows_of_steps;

/// The M − 1 steps between consecutive instants, seconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepStatistics {
    pub min: f64,
    pub median: f64,
    pub max: f64,
    /// A longer step is a gap.
    pub gap: f64,
}

/// `None` for fewer than two instants.
pub(crate) fn step_statistics(time: &[f64]) -> Option<StepStatistics> {
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_by(f64::total_cmp);
    let at = |q: f64| {
        let i = (q * (steps.len().saturating_sub(1)) as f64).round() as usize;
        steps.get(i).copied()
    };
    let median = at(0.5)?;
    Some(StepStatistics {
        min: at(0.0)?,
        median,
        max: at(1.0)?,
        gap: f64::max(
            TIME_AXIS.gap_over_median * median,
            TIME_AXIS.gap_over_percentile * at(0.95)?,
        ),
    })
}

/// Sample numbers of rising instants, from 0. A lost sample leaves a hole, so that no shift reaches across it.
pub(crate) fn sample_numbers(time: &[f64]) -> Vec<f64> {
    let step = step_statistics(time).map_or(1.0, |s| s.median);
    let later = time.windows(2).scan(0.0, |k, w| {
        // Counted from sample to sample, so that neither a gap nor a slow clock shifts what follows.
        *k += ((w[1] - w[0]) / step).round().max(1.0);
        Some(*k)
    });
    time.first().map(|_| 0.0).into_iter().chain(later).collect()
}

/// Rows that follow a gap in time.
pub fn gaps(time: &[f64]) -> Vec<usize> {
    let Some(s) = step_statistics(time) else {
        return Vec::new();
    };
    rows_of_steps(time, |a, b| b - a > s.gap)
}

/// Ranges of rows between gaps.
pub fn contiguous_ranges(time: &[f64]) -> Vec<std::ops::Range<usize>> {
    let mut ends = gaps(time);
    ends.push(time.len());
    let mut from = 0;
    let cut = ends
        .into_iter()
        .map(|to| std::mem::replace(&mut from, to)..to);
    cut.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_numbered_across_holes() {
        assert_eq!(
            sample_numbers(&[0.0, 0.1, 0.2, 0.5, 0.6]),
            [0.0, 1.0, 2.0, 5.0, 6.0]
        );
        // Behind a gap of ten samples and a half, no two fall together.
        let after_gap = sample_numbers(&[0.0, 1.0, 2.0, 12.5, 13.49, 14.49]);
        assert_eq!(after_gap, [0.0, 1.0, 2.0, 13.0, 14.0, 15.0]);
        assert!(sample_numbers(&[]).is_empty());
    }

    #[test]
    fn a_long_step_is_a_gap() {
        let mut time: Vec<f64> = (0..50).map(|k| k as f64 * 0.1).collect();
        time.iter_mut().skip(30).for_each(|t| *t += 2.0);
        assert_eq!(gaps(&time), [30]);
    }
}
