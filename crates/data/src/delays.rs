//! Records with their delays taken out: inputs as they act, and states as they were when their sensors read them.
//!
//! In: a dataset, delays in seconds. Out: a dataset of the same instants. A whole number of samples moves readings unchanged; between samples,
//! inputs are held, run straight or along cubics, and readings of states are interpolated by polynomials through six samples.
//! What a record does not say is missing. Estimates no delay.

use std::ops::Range;

use sidc_lang::model::Between;
use sidc_lang::term::{Signal, VarId};

use crate::cubic::Cubic;
use crate::dataset::{Dataset, Trajectory};
use crate::time_axis::contiguous_ranges;

sidc_thresholds::family! {
    /// How records are moved by delays.
    pub(crate) DELAY: DelayThresholds {
        /// Part of a sampling interval that counts as none.
        instant: f64 = 1e-6, unit "of the interval", source "time stamps of nine digits round intervals of a thousandth of the record by as much";
        /// Samples through which the polynomial of a reading between samples runs.
        points: usize = 6, unit "samples", source "derivatives of readings are taken by polynomials of this degree or less";
    }
}

/// The delay of one variable in seconds, positive if late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownDelay {
    pub var: VarId,
    pub seconds: f64,
}

/// What the value of a delayed input stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputValue {
    /// The input at the instant of the row.
    AtInstant,
    /// Of a held input, its mean until the next row; others as at the instant.
    OverStep,
}

/// The records with readings of these states, and of their derivatives, at the instants at which they were true.
pub fn with_true_readings(dataset: &Dataset, sensors: &[KnownDelay]) -> Dataset {
    moved(dataset, sensors, |time, values, seconds, _| {
        let at = |k: usize| reading(time, values, time.get(k).copied()? + seconds);
        (0..time.len()).map(|k| at(k).unwrap_or(f64::NAN)).collect()
    })
}

/// The records with these inputs, and their derivatives, as they act.
pub fn with_acting_inputs(dataset: &Dataset, inputs: &[KnownDelay], value: InputValue) -> Dataset {
    moved(dataset, inputs, |time, values, seconds, signal| {
        let between = dataset.between_samples(signal);
        let at = |k: usize| -> Option<f64> {
            let from = time.get(k).copied()? - seconds;
            match (between, value) {
                (Between::Linear, _) => straight(time, values, from),
                (Between::Cubic, _) => along_cubic(time, values, from),
                (Between::Hold, InputValue::AtInstant) => held_value(time, values, from),
                (Between::Hold, InputValue::OverStep) => {
                    let to = time.get(k + 1).map(|t| t - seconds);
                    held_mean(time, values, from, to.unwrap_or(from))
                }
            }
        };
        (0..time.len()).map(|k| at(k).unwrap_or(f64::NAN)).collect()
    })
}

/// Replaces every column of a delayed variable, on each uninterrupted piece, by what `value` makes of the piece's times and values, the
/// delay and the signal.
fn moved(
    dataset: &Dataset,
    delays: &[KnownDelay],
    value: impl Fn(&[f64], &[f64], f64, Signal) -> Vec<f64>,
) -> Dataset {
    let mut out = dataset.clone();
    for trajectory in &mut out.trajectories {
        let pieces: Vec<Range<usize>> = contiguous_ranges(&trajectory.time);
        let Trajectory { time, columns, .. } = trajectory;
        for (signal, column) in columns {
            let delay = delays.iter().find(|d| d.var == signal.var);
            let Some(delay) = delay.filter(|d| d.seconds != 0.0) else {
                continue;
            };
            for piece in &pieces {
                let (Some(time), Some(part)) =
                    (time.get(piece.clone()), column.get_mut(piece.clone()))
                else {
                    continue;
                };
                let new = value(time, part, delay.seconds, *signal);
                part.copy_from_slice(&new);
            }
        }
    }
    out
}

/// The row at or before an instant, and the part of the step that has passed since (0 to 1); 0 if the instant is that of the row but for
/// rounding. `None` outside the record.
fn place(time: &[f64], at: f64) -> Option<(usize, f64)> {
    let next = time.partition_point(|t| *t <= at);
    let (before, after) = (next.checked_sub(1), time.get(next));
    let (Some(row), Some(after)) = (before, after) else {
        let near = |row: usize, other: usize| {
            let (t, other) = (*time.get(row)?, *time.get(other)?);
            ((at - t).abs() <= DELAY.instant * (other - t).abs()).then_some((row, 0.0))
        };
        return match before {
            None => near(0, 1),
            Some(last) => near(last, last.checked_sub(1)?),
        };
    };
    let here = *time.get(row)?;
    let part = (at - here) / (after - here);
    Some(match part {
        p if p < DELAY.instant => (row, 0.0),
        p if p > 1.0 - DELAY.instant => (next, 0.0),
        p => (row, p),
    })
}

fn held_value(time: &[f64], values: &[f64], at: f64) -> Option<f64> {
    let (row, _) = place(time, at)?;
    values.get(row).copied()
}

/// Mean of a held input from one instant to another.
fn held_mean(time: &[f64], values: &[f64], from: f64, to: f64) -> Option<f64> {
    let (first, _) = place(time, from)?;
    let last = match place(time, to) {
        Some((row, part)) if part > 0.0 => row,
        Some((row, _)) => row.saturating_sub(1).max(first),
        None => first,
    };
    if first == last || to <= from {
        return values.get(first).copied();
    }
    let mut sum = 0.0;
    for row in first..=last {
        let start = time.get(row)?.max(from);
        let end = time.get(row + 1).copied().unwrap_or(to).min(to);
        sum += values.get(row)? * (end - start).max(0.0);
    }
    Some(sum / (to - from))
}

fn straight(time: &[f64], values: &[f64], at: f64) -> Option<f64> {
    let (row, part) = place(time, at)?;
    let here = values.get(row).copied()?;
    match part > 0.0 {
        true => Some(here + part * (values.get(row + 1)? - here)),
        false => Some(here),
    }
}

/// Along a cubic; straight where there is none.
fn along_cubic(time: &[f64], values: &[f64], at: f64) -> Option<f64> {
    let (row, part) = place(time, at)?;
    match Cubic::after(time, values, row).filter(|_| part > 0.0) {
        Some(cubic) => Some(cubic.at(at - time.get(row)?)),
        None => straight(time, values, at),
    }
}

/// A reading between samples by the polynomial of Lagrange through those around it; straight where some of them are missing.
fn reading(time: &[f64], values: &[f64], at: f64) -> Option<f64> {
    let (row, part) = place(time, at)?;
    if part == 0.0 {
        return values.get(row).copied();
    }
    let count = DELAY.points.min(time.len());
    let from = (row + 1).saturating_sub(count / 2).min(time.len() - count);
    let (times, known) = (
        time.get(from..from + count)?,
        values.get(from..from + count)?,
    );
    if known.iter().any(|v| !v.is_finite()) {
        return straight(time, values, at);
    }
    let weight = |i: usize, own: f64| -> f64 {
        let others = times.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, t)| (at - t) / (own - t)).product()
    };
    let terms = times.iter().zip(known).enumerate();
    Some(terms.map(|(i, (t, v))| weight(i, *t) * v).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Input;

    const STEP: f64 = 0.1;

    fn dataset(of: VarId, between: Option<Between>, value: impl Fn(f64) -> f64) -> Dataset {
        let time: Vec<f64> = (0..40).map(|k| k as f64 * STEP).collect();
        let values = time.iter().map(|t| value(*t)).collect();
        let input = |between| Input {
            var: of,
            between,
            declared: true,
        };
        Dataset {
            trajectories: vec![Trajectory {
                name: String::new(),
                file: 0,
                time,
                columns: vec![(Signal::new(of), values)],
            }],
            inputs: between.map(input).into_iter().collect(),
            ..Dataset::default()
        }
    }

    fn column(d: &Dataset) -> &[f64] {
        &d.trajectories[0].columns[0].1
    }

    const U: VarId = VarId(1);

    fn late(seconds: f64) -> [KnownDelay; 1] {
        [KnownDelay { var: U, seconds }]
    }

    #[test]
    fn whole_samples_move_values_unchanged() {
        for between in [Between::Hold, Between::Linear, Between::Cubic] {
            let d = dataset(U, Some(between), f64::exp);
            let moved = with_acting_inputs(&d, &late(0.3), InputValue::AtInstant);
            assert_eq!(column(&moved)[3..], column(&d)[..37]);
            assert!(column(&moved)[..3].iter().all(|x| x.is_nan()));
            let earlier = with_acting_inputs(&d, &late(-0.3), InputValue::AtInstant);
            assert_eq!(column(&earlier)[..37], column(&d)[3..]);
        }
    }

    #[test]
    fn a_cubic_input_is_followed_between_its_samples() {
        let d = dataset(U, Some(Between::Cubic), f64::sin);
        let moved = with_acting_inputs(&d, &late(0.137), InputValue::AtInstant);
        let acting = d.trajectories[0].time.iter().zip(column(&moved)).skip(2);
        for (t, u) in acting {
            assert!((u - (t - 0.137).sin()).abs() < 2e-5, "{t}: {u}");
        }
    }

    #[test]
    fn a_held_input_keeps_its_value_and_its_mean_counts_both_parts_of_a_step() {
        let d = dataset(U, Some(Between::Hold), |t| t.round());
        let d = &d;
        let at = with_acting_inputs(d, &late(0.037), InputValue::AtInstant);
        assert_eq!(column(&at)[1..], column(d)[..39]);
        let mean = with_acting_inputs(d, &late(0.037), InputValue::OverStep);
        for k in 1..39 {
            let expected = 0.37 * column(d)[k - 1] + 0.63 * column(d)[k];
            assert!((column(&mean)[k] - expected).abs() < 1e-9, "row {k}");
        }
    }

    #[test]
    fn a_late_reading_of_a_polynomial_is_put_back_exactly() {
        let quintic = |t: f64| t.powi(5) - 3.0 * t * t + 1.0;
        // The reading at t is of t - 0.0617.
        let d = dataset(U, None, |t| quintic(t - 0.0617));
        let moved = with_true_readings(&d, &late(0.0617));
        for (k, x) in column(&moved)[..39].iter().enumerate() {
            let t = k as f64 * STEP;
            assert!((x - quintic(t)).abs() < 1e-8, "row {k}: {x}");
        }
        assert!(column(&moved)[39].is_nan());
    }
}
