//! Whether a free run that departs from its readings says anything about the equations.
//!
//! In: a run, and the source to run it once more. Out: true if a start that differs by the error of the readings leads elsewhere: an
//! unstable plant, or chaos. Then a run from any start departs, of true equations too.

use std::ops::Range;

use crate::simulate::thresholds::{INITIAL_STATE, SEGMENTS};
use crate::simulate::{self, Options, Run, Source, Start};
use sidc_lang::term::Signal;
use sidc_progress::Observer;

/// The runs are compared over growing parts of the record, 1/64, 1/8 and all of it, until they depart. An early departure is cheap to
/// find; none at all costs a seventh more than one comparison of the whole. On records of 10⁵ samples chaotic runs depart within a
/// hundredth.
const PARTS: [usize; 3] = [64, 8, 1];

/// True if the run departs from its readings or ended early, and a second run, from a start moved by its standard error, departs from
/// the first by more than the bound of following.
pub(super) fn is_sensitive(
    source: &Source,
    (record, run): (usize, &Run),
    observer: &mut dyn Observer,
) -> bool {
    let departs = run.fault().is_some() || run.scores.iter().any(|s| s.follows.is_some());
    let Some(leg) = run.legs.first().filter(|_| departs) else {
        return false;
    };
    let moved = leg
        .start
        .iter()
        .map(|s| (s.signal, s.value + error(run, s)));
    let start: Vec<(Signal, f64)> = moved.collect();
    // Only the first leg is compared, up to the last row where the run has values: most departures come early, and the rest may take
    // long.
    let Some(rows) = with_values(run, leg.rows.clone()) else {
        return false;
    };
    PARTS.into_iter().any(|part| {
        let last = run.time.get(rows.start + rows.len().div_ceil(part) - 1);
        let options = Options {
            start: start.clone(),
            window: (run.time.get(rows.start).copied(), last.copied()),
            tolerance: SEGMENTS.tolerance,
            ..Options::default()
        };
        let other = simulate::simulate(source, record, &options, observer);
        other.is_ok_and(|other| depart(run, &other, rows.start))
    })
}

/// The rows up to the last one at which a scored signal has a value.
fn with_values(run: &Run, rows: Range<usize>) -> Option<Range<usize>> {
    let has_value = |k: &usize| {
        let mut scored = run.scores.iter().filter_map(|s| run.column(s.signal));
        scored.any(|column| column.get(*k).is_some_and(|x| x.is_finite()))
    };
    let last = rows.clone().rev().find(has_value)?;
    Some(rows.start..last + 1)
}

/// Whether two runs depart from each other by more than the bound of following; the first row of `other` is row `start` of `run`.
fn depart(run: &Run, other: &Run, start: usize) -> bool {
    run.scores.iter().any(|score| {
        let (Some(one), Some(two)) = (run.column(score.signal), other.column(score.signal)) else {
            return false;
        };
        let both = one.iter().skip(start).zip(two);
        let apart = both.filter(|(a, b)| a.is_finite() && b.is_finite());
        apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) > score.bound
    })
}

/// Standard error of a component of the start; of clean readings the noise up to which they count as clean.
fn error(run: &Run, start: &Start) -> f64 {
    let size = run.column(start.signal).map_or(0.0, |values| {
        let finite = values.iter().filter(|v| v.is_finite());
        finite.fold(0.0, |m: f64, v| m.max(v.abs()))
    });
    start.error.unwrap_or(0.0).max(INITIAL_STATE.clean * size)
}
