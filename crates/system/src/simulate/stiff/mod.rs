//! Stiff flows: the Radau IIA method of order 9, with error control.
//!
//! In: a flow, a state, instants to stop at. Out: the states there, or where and why it ends. Steps are as long as the error
//! allows; instants within a step are read off its polynomial, if that is as exact as the step. Every call starts without history.
//! Hairer, Wanner, "Solving Ordinary Differential Equations II", IV.8; Gustafsson, "Control-theoretic techniques for stepsize
//! selection in implicit Runge–Kutta methods", ACM Trans. Math. Softw. 20 (1994).

mod lu;
mod radau;
mod tableau;

use super::fault::FaultKind;
use super::flow::{Ended, Flow, Guard};
use radau::{ITERATIONS, Outcome, Radau, Span, norm};
use tableau::STAGES;

/// Error of a step, relative to a state and its typical size together.
const TOLERANCE: f64 = 1e-10;
/// Steps that the right side fails in one after another.
const RETRIES: usize = 20;
/// What is left of such a step.
const BACK: f64 = 1.0 / 8.0;
/// Steps are not made smaller than this, relative to the time.
const SMALLEST: f64 = 1e-15;
/// The first step, in units of the time in which the state moves by its size or bends: the sixth power of this, times the error's
/// constant of 1e-5, is a tenth of the tolerance.
const FIRST: f64 = 0.1;
/// What an error grows with as the step does, inverted.
const POWER: f64 = 1.0 / (STAGES as f64 + 1.0);
/// Steps are chosen for an error somewhat below the allowed one.
const SAFETY: f64 = 0.9;
/// A step's least and largest part of the next one.
const CHANGE: (f64, f64) = (1.0 / 8.0, 5.0);
/// Growth that is not worth new factors.
const KEEP: f64 = 1.2;
/// What is left of a first step that was far too long.
const AGAIN: f64 = 0.1;
/// The least error that a trend is told from: below, it is chance.
const CHANCE: f64 = 1e-2;
/// Errors are rounding below this, and allow no longer steps.
const ROUNDING: f64 = 1e-9;
/// A step this close to what lies ahead is stretched to it.
const STRETCH: f64 = 0.999;

/// From `t` to the last of `stops`, the inputs' lines as they are. `reached` grows by the state at each stop; `x` is left at the
/// last one.
pub(super) fn advance(
    flow: &mut Flow,
    (mut t, stops): (f64, &[f64]),
    x: &mut [f64],
    guard: &mut Guard,
    reached: &mut Vec<Vec<f64>>,
) -> Result<(), Ended> {
    let mut radau = Radau::new(x.len());
    let mut stops = stops.iter().copied().peekable();
    let Some(last) = stops.clone().last() else {
        return Ok(());
    };
    let mut scale = vec![0.0; x.len()];
    allow(&mut scale, x, guard);
    let slope = radau.begin(flow, t, x).map_err(|kind| (kind, t))?.to_vec();
    let mut pace = Pace::new(first(&radau.jacobian, &slope, &scale));
    // A failure stands until the time has passed the end of the step that met it.
    let mut failed: Option<Ended> = None;
    let mut failures = 0;
    while let Some(stop) = stops.peek().copied() {
        let smallest = SMALLEST * t.abs().max(stop.abs());
        if stop - t <= smallest {
            reached.push(x.to_vec());
            stops.next();
            continue;
        }
        let span = pace.span(t, stop, last);
        if span.h <= smallest {
            let kind = failed.map_or(FaultKind::StepTooSmall, |(kind, _)| kind);
            return Err((kind, t));
        }
        if flow.work.calls > guard.budget {
            return Err((FaultKind::TooMuchWork, t));
        }
        match radau.attempt(flow, span, x, &scale, pace.unsure()) {
            Err(kind) => {
                // The trial step may have left the domain of the equations; a shorter one may not.
                failed = Some((kind, span.end));
                failures += 1;
                if failures > RETRIES {
                    return Err((kind, t));
                }
                pace.shorten(BACK * span.h);
            }
            Ok(Outcome::TooLong(factor)) => pace.shorten(factor * span.h),
            Ok(Outcome::Tried {
                error,
                within,
                iterations,
            }) => {
                let through = stop < span.end;
                if !pace.judge(span.h, error, (within, through), iterations) {
                    continue;
                }
                failures = 0;
                failed = failed.filter(|(_, end)| span.end < *end);
                let (from, before) = (t, x.to_vec());
                radau.accept(span.h, x);
                t = span.end;
                guard.check(t, x, flow.work.calls)?;
                while let Some(stop) = stops.next_if(|stop| *stop < t) {
                    reached.push(radau.within((stop - from) / span.h, &before));
                }
                allow(&mut scale, x, guard);
            }
        }
    }
    Ok(())
}

/// The error allowed of each component.
fn allow(scale: &mut [f64], x: &[f64], guard: &Guard) {
    for ((scale, x), size) in scale.iter_mut().zip(x).zip(&guard.sizes) {
        *scale = TOLERANCE * (x.abs() + size);
    }
}

/// A first step, from how fast the state moves and bends: slope and J · slope.
fn first(jacobian: &[f64], slope: &[f64], scale: &[f64]) -> f64 {
    let rows = jacobian.chunks_exact(slope.len().max(1));
    let bends: Vec<f64> = rows
        .map(|row| row.iter().zip(slope).map(|(j, s)| j * s).sum())
        .collect();
    let moves = TOLERANCE * norm(slope, scale);
    let bends = (TOLERANCE * norm(&bends, scale)).sqrt();
    FIRST / moves.max(bends).max(f64::MIN_POSITIVE)
}

/// How long steps are.
#[derive(Clone, Copy, Debug)]
struct Pace {
    /// The step that the last error suggests.
    h: f64,
    /// The step over which the polynomial would be exact enough.
    through: f64,
    /// The last good step, and its error.
    good: Option<(f64, f64)>,
    /// The last attempt failed.
    rejected: bool,
}

impl Pace {
    fn new(h: f64) -> Pace {
        Pace {
            h,
            through: h,
            good: None,
            rejected: false,
        }
    }

    /// Errors may be overestimated.
    fn unsure(&self) -> bool {
        self.rejected || self.good.is_none()
    }

    fn shorten(&mut self, h: f64) {
        self.h = h;
        self.rejected = true;
    }

    /// The next step: to the next stop, or beyond it if the polynomial allows that.
    fn span(&self, t: f64, stop: f64, last: f64) -> Span {
        let (near, far) = (stop - t, last - t);
        let h = self.h.min(self.through.max(near));
        // A step is stretched a little, or halved, rather than leaving a sliver.
        let to = |end: f64, h: f64| Span { t, end, h };
        let ahead = if self.through > near { far } else { near };
        let end = if ahead == far { last } else { stop };
        if h >= STRETCH * ahead {
            to(end, ahead)
        } else if h > 0.5 * ahead {
            to(t + 0.5 * ahead, 0.5 * ahead)
        } else {
            to(t + h, h)
        }
    }

    /// Whether a step is good, and how long the next one is.
    fn judge(
        &mut self,
        h: f64,
        error: f64,
        (within, through): (f64, bool),
        iterations: usize,
    ) -> bool {
        self.through = SAFETY * h * within.max(ROUNDING).powf(-POWER);
        let most = 2.0 * ITERATIONS as f64;
        let safety = SAFETY * (most + 1.0) / (most + iterations as f64);
        let part = |error: f64, safety: f64| {
            (error.max(ROUNDING).powf(POWER) / safety).clamp(CHANGE.0, CHANGE.1)
        };
        if error >= 1.0 {
            let part = part(error, safety);
            self.shorten(if self.good.is_none() {
                AGAIN * h
            } else {
                h / part
            });
            return false;
        }
        if through && within >= 1.0 {
            return false;
        }
        let mut next = h / part(error, safety);
        if let Some((last, last_error)) = self.good {
            // Errors that grow from step to step will go on to.
            let trend = part(error * error / last_error, SAFETY * h / last);
            next = next.min(h / trend);
        }
        if self.rejected {
            next = next.min(h);
        }
        if (1.0..KEEP).contains(&(next / h)) {
            next = h;
        }
        // A step cut short by a stop says nothing against a longer one.
        let cut = h < self.h && !self.rejected;
        self.h = if cut { next.max(self.h) } else { next };
        self.good = Some((h, error.max(CHANCE)));
        self.rejected = false;
        true
    }
}
