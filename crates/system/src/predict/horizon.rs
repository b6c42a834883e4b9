//! How far ahead is asked for where the user does not say: as far as the last value of some signal says more than its mean.
//!
//! In: records, the signals that are predicted with their spread and noise. Out: a horizon and the rule that gave it. Knows no
//! equations, so that all models of the same data are asked the same.

use std::ops::Range;

use super::document::HorizonChoice;
use super::thresholds::PREDICTION;
use sidc_data::Trajectory;
use sidc_lang::term::Signal;

/// A signal that is predicted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Predicted {
    pub signal: Signal,
    /// Place among the components of the state.
    pub place: usize,
    pub spread: f64,
    pub noise: f64,
    /// Rows to either side of a horizon in which its reading is taken: none where every row has one, else half of those between two
    /// readings.
    pub reach: usize,
}

impl Predicted {
    /// The reading nearest to a row among rows of `within`, and its row.
    pub fn reading(
        &self,
        record: &Trajectory,
        row: usize,
        within: &Range<usize>,
    ) -> Option<(usize, f64)> {
        let column = record.column(self.signal)?;
        let near = (0..=self.reach).flat_map(|d| [row.checked_sub(d), Some(row + d)]);
        let mut read = near
            .flatten()
            .filter(|k| within.contains(k))
            .filter_map(|k| Some((k, *column.get(k)?)));
        read.find(|(_, value)| value.is_finite())
    }
}

/// [`Predicted::reach`] of a signal that is read in so many of the rows; a tenth of them lost is still every row.
pub(super) fn reach(rows: usize, readings: usize) -> usize {
    (2 * rows + readings) / (4 * readings.max(1))
}

/// The horizon in seconds (samples in discrete time). `longest` is the longest uninterrupted record, in the same unit.
pub(super) fn choose(
    records: &[&Trajectory],
    signals: &[Predicted],
    longest: f64,
) -> (f64, HorizonChoice) {
    let most = longest / PREDICTION.record_part as f64;
    let step = median_step(records);
    let mut rows = 1;
    while (rows as f64) * step < most {
        if signals.iter().any(|s| has_changed(records, s, rows)) {
            return (rows as f64 * step, HorizonChoice::NoChange);
        }
        // Lags grow by a tenth, which bounds the work by that of some fifty of them.
        rows = (rows + 1).max(rows * 11 / 10);
    }
    let rows = (most / step).floor().max(1.0);
    (rows * step, HorizonChoice::Record)
}

/// True if the value so many rows before has an error of the signal's spread, noise of readings taken off.
fn has_changed(records: &[&Trajectory], s: &Predicted, rows: usize) -> bool {
    let (mut sum, mut count) = (0.0, 0_usize);
    for values in records.iter().filter_map(|t| t.column(s.signal)) {
        for (now, then) in values.iter().zip(values.iter().skip(rows)) {
            if now.is_finite() && then.is_finite() {
                sum += (then - now).powi(2);
                count += 1;
            }
        }
    }
    let square = sum / count.max(1) as f64 - 2.0 * s.noise.powi(2);
    square >= (PREDICTION.no_change * s.spread).powi(2)
}

/// Median time between two rows; 1 without two rows.
pub(super) fn median_step(records: &[&Trajectory]) -> f64 {
    sidc_data::median_step(records.iter().map(|t| t.time.as_slice())).unwrap_or(1.0)
}

/// The row so far ahead, to half a step; `None` behind the end or in a gap.
pub(super) fn row_ahead(time: &[f64], row: usize, ahead: f64, step: f64) -> Option<usize> {
    let wanted = time.get(row)? + ahead;
    let after = time.partition_point(|t| *t < wanted);
    let near = [after.checked_sub(1), Some(after)].into_iter().flatten();
    let near = near.filter_map(|k| Some((k, (time.get(k)? - wanted).abs())));
    let (k, off) = near.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (off <= 0.501 * step && k > row).then_some(k)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::VarId;

    fn sine(period: f64, rows: usize) -> Trajectory {
        let time: Vec<f64> = (0..rows).map(|k| 0.01 * k as f64).collect();
        let turn = |t: &f64| (std::f64::consts::TAU * t / period).sin();
        let values = time.iter().map(turn).collect();
        Trajectory {
            columns: vec![(Signal::new(VarId(1)), values)],
            time,
            ..Trajectory::default()
        }
    }

    fn signal() -> Predicted {
        Predicted {
            signal: Signal::new(VarId(1)),
            place: 0,
            spread: 0.5_f64.sqrt(),
            noise: 0.0,
            reach: 0,
        }
    }

    #[test]
    fn a_sixth_of_a_period_is_where_the_last_value_says_no_more_than_the_mean() {
        let record = sine(3.0, 3_000);
        let (horizon, rule) = choose(&[&record], &[signal()], 30.0);
        assert_eq!(rule, HorizonChoice::NoChange);
        assert!((horizon - 0.5).abs() < 0.06, "{horizon}");
    }

    #[test]
    fn slow_data_are_asked_for_a_fifth_of_the_record() {
        let record = sine(300.0, 1_000);
        let (horizon, rule) = choose(&[&record], &[signal()], 10.0);
        assert_eq!(rule, HorizonChoice::Record);
        assert!((horizon - 2.0).abs() < 0.02, "{horizon}");
    }

    #[test]
    fn rows_ahead_are_found_by_time_and_not_across_gaps() {
        let time = [0.0, 1.0, 2.0, 3.1, 9.0];
        assert_eq!(row_ahead(&time, 0, 3.0, 1.0), Some(3));
        assert_eq!(row_ahead(&time, 0, 5.0, 1.0), None);
        assert_eq!(row_ahead(&time, 3, 10.0, 1.0), None);
    }

    #[test]
    fn a_reading_of_a_slower_sensor_is_the_nearest() {
        assert_eq!(
            [(10, 10), (10, 9), (12, 8), (10, 4), (10, 1)].map(|(m, k)| reach(m, k)),
            [0, 0, 1, 1, 5]
        );
        let record = Trajectory {
            time: (0..8).map(f64::from).collect(),
            columns: vec![(
                signal().signal,
                vec![
                    1.0,
                    f64::NAN,
                    f64::NAN,
                    4.0,
                    f64::NAN,
                    f64::NAN,
                    7.0,
                    f64::NAN,
                ],
            )],
            ..Trajectory::default()
        };
        let slow = Predicted {
            reach: 1,
            ..signal()
        };
        let read = |row: usize| slow.reading(&record, row, &(1..8));
        assert_eq!(
            [3, 4, 5, 2].map(read),
            [
                Some((3, 4.0)),
                Some((3, 4.0)),
                Some((6, 7.0)),
                Some((3, 4.0))
            ]
        );
        assert_eq!(read(1), None, "row 0 is the start");
        assert_eq!(signal().reading(&record, 4, &(1..8)), None);
    }
}
