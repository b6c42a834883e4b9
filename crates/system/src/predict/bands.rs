//! Bands about predictions that are to hold 90 % of the readings, and how many they do hold.
//!
//! In: states along data used and held out, starts, how far ahead. Out: a [`Band`] for each signal. Assumes nothing of the noise.
//!
//! The half width is the error that 90 % of the predictions on the data used stay within (split conformal prediction; Vovk, Gammerman and
//! Shafer 2005). Data held out may differ from them. So a second band follows: each time a prediction comes true, its logarithm rises a little
//! if the reading lay outside and falls a ninth of that if inside, which in the long run holds 90 % of any sequence whatever (Gibbs and
//! Candès 2021; Angelopoulos, Candès and Tibshirani 2023, quantile tracking).

use super::document::{Band, BandHeldOut, PredictedReading};
use super::horizon::{Predicted, row_ahead};
use super::state_estimation::StateEstimator;
use super::test_starts::TestStart;
use super::thresholds::BAND;
use sidc_progress::{Activity, Observer};
use std::collections::VecDeque;

/// Predictions from all starts of some data, as far ahead as asked for.
pub(super) struct Ahead<'a> {
    pub estimators: &'a [StateEstimator<'a>],
    pub starts: &'a [TestStart],
    pub ahead: f64,
    pub step: f64,
    pub fitted_rows: usize,
}

/// A prediction and the reading that it was compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Compared {
    record: usize,
    /// The time at which it was made, and that of the reading.
    made: f64,
    time: f64,
    predicted: f64,
    read: f64,
}

impl Compared {
    fn error(&self) -> f64 {
        (self.predicted - self.read).abs()
    }
}

impl Ahead<'_> {
    /// For each signal the predictions whose runs reach the horizon and that have a reading there; fewer where the observer ends the work.
    fn compare(&self, signals: &[Predicted], observer: &mut dyn Observer) -> Vec<Vec<Compared>> {
        let mut out = vec![Vec::new(); signals.len()];
        for start in self.starts {
            let Some(estimator) = self.estimators.get(start.record) else {
                continue;
            };
            let record = estimator.runs.record();
            let made = record.time.get(start.row).copied().unwrap_or(0.0);
            if observer.hear(Activity::Running { time: made }).is_break() {
                break;
            }
            let row = row_ahead(&record.time, start.row, self.ahead, self.step);
            let state = estimator.state(start.row, self.fitted_rows, observer).ok();
            let reached = row.zip(state);
            let Some((row, Some(x))) =
                reached.map(|(row, x)| (row, estimator.reach(start.row..row, &x, observer)))
            else {
                continue;
            };
            for (s, all) in signals.iter().zip(&mut out) {
                let read = record.column(s.signal).and_then(|c| c.get(row)).copied();
                let both = read.zip(x.get(s.place).copied());
                let Some((read, predicted)) = both.filter(|(r, p)| r.is_finite() && p.is_finite())
                else {
                    continue;
                };
                all.push(Compared {
                    record: start.record,
                    made,
                    time: record.time.get(row).copied().unwrap_or(made),
                    predicted,
                    read,
                });
            }
        }
        out
    }
}

/// The band of each signal; `None` where no prediction on the data used could be compared, or 90 % of them have no error.
pub(super) fn bands(
    used: &Ahead,
    held: &Ahead,
    signals: &[Predicted],
    observer: &mut dyn Observer,
) -> Vec<Option<Band>> {
    let used = used.compare(signals, observer);
    let held = held.compare(signals, observer);
    let pairs = used.iter().zip(&held);
    pairs.map(|(used, held)| band(used, held)).collect()
}

fn band(used: &[Compared], held: &[Compared]) -> Option<Band> {
    let mut errors: Vec<f64> = used.iter().map(Compared::error).collect();
    let half_width = conformal_90(&mut errors).filter(|w| *w > 0.0)?;
    Some(Band {
        half_width,
        predictions: used.len(),
        held_out: (!held.is_empty()).then(|| follow(half_width, held)),
    })
}

/// The half width of a band that holds a new prediction of the same kind with a probability of at least 90 % (split conformal prediction):
/// one rank above the quantile of the errors. `None` below nine errors.
fn conformal_90(errors: &mut [f64]) -> Option<f64> {
    errors.sort_by(f64::total_cmp);
    let rank = (9 * (errors.len() + 1)).div_ceil(10);
    errors.get(rank.checked_sub(1)?).copied()
}

/// Compares predictions of data held out with the fixed band, and with one that is adapted as the errors of earlier predictions become
/// known.
fn follow(half_width: f64, held: &[Compared]) -> BandHeldOut {
    let mut followed = half_width;
    let mut open: VecDeque<(Compared, f64)> = VecDeque::new();
    let mut course = Vec::new();
    let (mut fixed, mut following) = (0, 0);
    for p in held {
        let known = |o: &(Compared, f64)| o.0.record != p.record || o.0.time <= p.made;
        while let Some((past, width)) = open.front().filter(|o| known(o)) {
            followed = next_half_width(followed, past.error() <= *width);
            open.pop_front();
        }
        fixed += usize::from(p.error() <= half_width);
        following += usize::from(p.error() <= followed);
        open.push_back((*p, followed));
        course.push(PredictedReading {
            record: p.record,
            time: p.time,
            predicted: p.predicted,
            read: p.read,
            half_width: followed,
        });
    }
    let share = |count: usize| count as f64 / held.len().max(1) as f64;
    BandHeldOut {
        fixed: share(fixed),
        following: share(following),
        half_width: followed,
        course,
    }
}

/// The half width after a prediction was compared: wider if the band missed the reading, a ninth as much narrower if it held it.
fn next_half_width(half_width: f64, held: bool) -> f64 {
    let missed = if held { 0.0 } else { 1.0 };
    half_width * (BAND.rate * (missed - 0.1)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Predictions one ahead, with these errors.
    fn compared(errors: impl Iterator<Item = f64>) -> Vec<Compared> {
        let one = |(k, e): (usize, f64)| Compared {
            record: 0,
            made: k as f64,
            time: k as f64 + 1.0,
            predicted: e,
            read: 0.0,
        };
        errors.enumerate().map(one).collect()
    }

    /// Errors spread evenly up to `largest`, in no order.
    fn scattered(n: usize, largest: f64) -> impl Iterator<Item = f64> {
        (1..=n).map(move |k| largest * (0.618_033_988_75 * k as f64).fract())
    }

    #[test]
    fn errors_of_the_same_kind_are_held_nine_times_in_ten() {
        let band = band(
            &compared(scattered(400, 1.0)),
            &compared(scattered(400, 1.0)),
        );
        let band = band.unwrap();
        assert!((band.half_width - 0.9).abs() < 0.01, "{band:?}");
        let held = band.held_out.unwrap();
        assert!((held.fixed - 0.9).abs() < 0.01, "{held:?}");
        assert!((held.following - 0.9).abs() < 0.03, "{held:?}");
    }

    #[test]
    fn a_band_follows_errors_that_double() {
        let band = band(
            &compared(scattered(400, 1.0)),
            &compared(scattered(400, 2.0)),
        );
        let held = band.unwrap().held_out.unwrap();
        assert!((held.fixed - 0.45).abs() < 0.01, "{held:?}");
        assert!((held.following - 0.9).abs() < 0.05, "{held:?}");
        assert!((held.half_width - 1.8).abs() < 0.3, "{held:?}");
    }

    #[test]
    fn nothing_is_learnt_from_predictions_that_are_still_open() {
        let mut far = compared(std::iter::repeat_n(5.0, 20));
        far.iter_mut().for_each(|p| p.time += 100.0);
        let held = follow(1.0, &far);
        assert!(held.course.iter().all(|p| p.half_width == 1.0));
        assert_eq!((held.fixed, held.following), (0.0, 0.0));
    }

    #[test]
    fn eight_errors_are_too_few() {
        assert!(band(&compared(scattered(8, 1.0)), &[]).is_none());
        assert!(band(&compared(scattered(9, 1.0)), &[]).is_some());
    }
}
