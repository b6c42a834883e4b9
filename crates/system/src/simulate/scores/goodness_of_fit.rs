//! Goodness of fit of a simulated signal.
//!
//! In: simulated and measured values of one signal, the legs of the run. Out: a [`Score`].

use std::ops::Range;

use crate::simulate::run::{Leg, Score};
use crate::simulate::thresholds::SCORES;
use sidc_lang::term::Signal;

/// Up to which error a run follows a signal.
pub(crate) struct FollowingLimit {
    /// In standard deviations of the measured signal.
    pub bound: f64,
    /// Standard deviation of the readings' noise, in the signal's unit.
    pub noise: f64,
}

/// Compares the rows after each leg's start at which both values are finite; `None` if there are none.
pub(crate) fn score(
    signal: Signal,
    time: &[f64],
    (simulated, measured): (&[f64], &[f64]),
    legs: &[Leg],
    limit: &FollowingLimit,
) -> Option<Score> {
    let pair = |i: usize| -> Option<(f64, f64)> {
        let (s, m) = (*simulated.get(i)?, *measured.get(i)?);
        (s.is_finite() && m.is_finite()).then_some((s, m))
    };
    let tested = |l: &Leg| l.rows.start + l.settled.max(1)..l.rows.end;
    let rows: Vec<usize> = legs.iter().flat_map(tested).collect();
    let pairs: Vec<(f64, f64)> = rows.into_iter().filter_map(pair).collect();
    let n = pairs.len() as f64;
    if pairs.is_empty() {
        return None;
    }
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>();
    let square = sum(&|(s, m)| (s - m).powi(2));
    let energy = sum(&|(_, m)| m * m);
    let mean = sum(&|(_, m)| *m) / n;
    // The fit of a signal that does not move is undefined.
    let spread = match sum(&|(_, m)| (m - mean).powi(2)) {
        spread if spread > 1e-24 * energy => spread,
        _ => f64::NAN,
    };
    let bound = limit.bound * deviation(measured);
    let beyond = bound.hypot(SCORES.noise * limit.noise);
    // From each leg's start to where it departs, or to its fault.
    let follows = legs.iter().filter_map(|l| {
        let begin = *time.get(l.rows.start)?;
        let off = |i: usize| pair(i).map(|(s, m)| (s - m).abs() > beyond);
        let first = departure(l.rows.clone(), &off).and_then(|i| time.get(i).copied());
        first
            .or(l.fault.as_ref().map(|f| f.time))
            .map(|t| t - begin)
    });
    Some(Score {
        signal,
        rows: pairs.len(),
        mse: square / n,
        mae: sum(&|(s, m)| (s - m).abs()) / n,
        error_to_signal: 10.0 * (square / energy).log10(),
        fit: 100.0 * (1.0 - (square / spread).sqrt()),
        r_squared: 1.0 - square / spread,
        follows: follows.reduce(f64::min),
        bound,
    })
}

/// The first row that is off together with most of the compared rows behind it: a single reading may be wrong.
fn departure(rows: Range<usize>, off: &dyn Fn(usize) -> Option<bool>) -> Option<usize> {
    let compared: Vec<(usize, bool)> = rows.filter_map(|i| Some((i, off(i)?))).collect();
    let departs = |k: &usize| {
        let next = compared.iter().skip(*k).take(SCORES.rows);
        let (all, off) = next.fold((0, 0), |(n, off), (_, o)| (n + 1, off + usize::from(*o)));
        compared.get(*k).is_some_and(|(_, o)| *o) && 2 * off > all
    };
    let first = (0..compared.len()).find(departs)?;
    compared.get(first).map(|(row, _)| *row)
}

/// Standard deviation of the finite values.
pub(crate) fn deviation(values: &[f64]) -> f64 {
    let finite = || values.iter().filter(|v| v.is_finite());
    let n = finite().count().max(1) as f64;
    let mean = finite().sum::<f64>() / n;
    (finite().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_readings_are_no_departure_and_most_of_five_are() {
        let first = |off: &[u8]| departure(0..off.len(), &|i| off.get(i).map(|o| *o == 1));
        assert_eq!(first(&[0, 1, 0, 0, 1, 0, 0, 0, 1, 0]), None);
        assert_eq!(first(&[0, 1, 0, 0, 0, 1, 0, 1, 1, 0]), Some(5));
        assert_eq!(first(&[1, 1, 1]), Some(0));
        // Rows without a reading are passed over.
        let gaps = departure(0..9, &|i| (i % 2 == 0).then_some(i > 3));
        assert_eq!(gaps, Some(4));
    }

    /// Noise of 0.2 spreads is beyond a quarter of the spread in every fifth row.
    #[test]
    fn a_run_is_not_left_for_the_noise_of_its_readings() {
        let time: Vec<f64> = (0..400).map(f64::from).collect();
        let run: Vec<f64> = time.iter().map(|t| (0.1 * t).sin()).collect();
        let noise = |k: usize| 0.14 * [0.3, -1.9, 0.8, 2.1, -0.6, -0.2, 1.7, -1.1][k * k % 8];
        let read: Vec<f64> = run.iter().enumerate().map(|(k, x)| x + noise(k)).collect();
        let legs = [Leg {
            rows: 0..time.len(),
            ..Leg::default()
        }];
        let follows = |measured: &[f64], noise| {
            let limit = FollowingLimit { bound: 0.25, noise };
            let signal = Signal::new(sidc_lang::term::VarId(1));
            let found = score(signal, &time, (&run, measured), &legs, &limit);
            found.unwrap().follows
        };
        assert_eq!(follows(&read, 0.14), None);
        let shifted: Vec<f64> = (read.iter().zip(&time))
            .map(|(x, t)| if *t < 200.0 { *x } else { x + 1.0 })
            .collect();
        let left = follows(&shifted, 0.14).unwrap();
        assert!((left - 200.0).abs() < 5.0, "{left}");
    }
}
