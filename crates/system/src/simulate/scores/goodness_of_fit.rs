//! Goodness of fit of a simulated signal.
//!
//! In: simulated and measured values of one signal, the legs of the run. Out: a [`Score`].

use crate::simulate::run::{Leg, Score};
use sidc_lang::term::Signal;

/// Compares the rows after each leg's start at which both values are finite; `None` if there are none. `bound` is in
/// standard deviations of the measured signal.
pub(crate) fn score(
    signal: Signal,
    time: &[f64],
    (simulated, measured): (&[f64], &[f64]),
    legs: &[Leg],
    bound: f64,
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
    let bound = bound * deviation(measured);
    // From each leg's start to its first row beyond the bound, or to its fault.
    let follows = legs.iter().filter_map(|l| {
        let begin = *time.get(l.rows.start)?;
        let off = |i: &usize| pair(*i).is_some_and(|(s, m)| (s - m).abs() > bound);
        let first = l.rows.clone().find(off).and_then(|i| time.get(i).copied());
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

/// Standard deviation of the finite values.
pub(crate) fn deviation(values: &[f64]) -> f64 {
    let finite = || values.iter().filter(|v| v.is_finite());
    let n = finite().count().max(1) as f64;
    let mean = finite().sum::<f64>() / n;
    (finite().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}
