//! Whether a free run that departs from its readings says anything about the equations.
//!
//! In: a run, and the source to run it once more. Out: true if a start that differs by the error of the readings leads elsewhere: an
//! unstable plant, or chaos. Then a run from any start departs, of true equations too.

use crate::simulate::thresholds::{INITIAL_STATE, SEGMENTS};
use crate::simulate::{self, Options, Run, Source, Start};
use sidc_progress::Observer;

/// True if the run departs or ended, and another from a start moved by its error departs from it by the bound of following.
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
    // Only the first leg starts elsewhere, so only that is run.
    let end = leg.rows.end.checked_sub(1).and_then(|k| run.time.get(k));
    let options = Options {
        start: moved.collect(),
        window: (run.time.get(leg.rows.start).copied(), end.copied()),
        tolerance: SEGMENTS.tolerance,
        ..Options::default()
    };
    let Ok(other) = simulate::simulate(source, record, &options, observer) else {
        return false;
    };
    run.scores.iter().any(|score| {
        let (Some(one), Some(two)) = (run.column(score.signal), other.column(score.signal)) else {
            return false;
        };
        let both = one.iter().skip(leg.rows.start).zip(two);
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
