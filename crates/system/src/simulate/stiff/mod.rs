//! Stiff flows: the Radau IIA method of order 9, with error control.
//!
//! In: a right side, a state, instants to stop at. Out: the states there, or where and why integration ended. Steps are as long as the error
//! allows. States within a step are values of its polynomial, if that is as exact as the step. Every call starts without history.
//! Hairer, Wanner, "Solving Ordinary Differential Equations II", IV.8; Gustafsson, "Control-theoretic techniques for stepsize
//! selection in implicit Runge–Kutta methods", ACM Trans. Math. Softw. 20 (1994).

mod lu;
mod radau;
mod tableau;

use super::fault::FaultKind;
use super::forced_right_side::{Ended, ForcedRightSide, Guard};
use super::integrate::event_crossing::{EventCrossing, crossing};
use super::thresholds::IMPLICIT;
use radau::{Outcome, Radau, Span, norm};
use tableau::STAGES;

/// The error grows with the step to the power of stages + 1; this is the inverse of that power.
const ERROR_EXPONENT: f64 = 1.0 / (STAGES as f64 + 1.0);

/// Integrates from `t` to the last of `stops` with the present segments of the inputs. Adds the state at each stop to `reached`; `x` ends as the
/// state at the last one.
pub(super) fn advance(
    right_side: &mut ForcedRightSide,
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
    let slope = radau
        .begin(right_side, t, x)
        .map_err(|kind| (kind, t))?
        .to_vec();
    let mut control = StepControl::new(first(&radau.jacobian, &slope, &scale));
    // A failure is kept until the time has passed the end of the step in which it occurred.
    let mut failed: Option<Ended> = None;
    let mut failures = 0;
    while let Some(stop) = stops.peek().copied() {
        let smallest = IMPLICIT.smallest_step * t.abs().max(stop.abs());
        if stop - t <= smallest {
            reached.push(x.to_vec());
            stops.next();
            continue;
        }
        let span = control.span(t, stop, last);
        if span.h <= smallest {
            let kind = failed.map_or(FaultKind::StepTooSmall, |(kind, _)| kind);
            return Err((kind, t));
        }
        if right_side.work.calls > guard.budget {
            return Err((FaultKind::TooMuchWork, t));
        }
        match radau.attempt(right_side, span, x, &scale, control.error_is_uncertain()) {
            Err(kind) => {
                // The trial step may have left the domain of the equations; a shorter one may not.
                failed = Some((kind, span.end));
                failures += 1;
                if failures > IMPLICIT.failures {
                    return Err((kind, t));
                }
                control.shorten(IMPLICIT.after_failure * span.h);
            }
            Ok(Outcome::TooLong(factor)) => control.shorten(factor * span.h),
            Ok(Outcome::Tried {
                error,
                within,
                iterations,
            }) => {
                let through = stop < span.end;
                if !control.judge(span.h, error, (within, through), iterations) {
                    continue;
                }
                failures = 0;
                failed = failed.filter(|(_, end)| span.end < *end);
                let (from, before) = (t, x.to_vec());
                radau.accept(span.h, x);
                t = span.end;
                guard.check(t, x, right_side.work.calls)?;
                if let Some((part, switches)) =
                    event(right_side, &radau, (from, span.h), &before, x)
                        .map_err(|kind| (kind, from))?
                {
                    t = if part == 1.0 {
                        span.end
                    } else {
                        from + part * span.h
                    };
                    while let Some(stop) = stops.next_if(|stop| *stop < t) {
                        reached.push(radau.within((stop - from) / span.h, &before));
                    }
                    let there = x.to_vec();
                    x.copy_from_slice(&radau.within(part, &before));
                    right_side
                        .pass_event((t, x), &guard.sizes, (part, &switches, &there))
                        .map_err(|kind| (kind, t))?;
                    allow(&mut scale, x, guard);
                    radau = Radau::new(x.len());
                    let slope = radau
                        .begin(right_side, t, x)
                        .map_err(|kind| (kind, t))?
                        .to_vec();
                    control = StepControl::new(first(&radau.jacobian, &slope, &scale));
                    continue;
                }
                while let Some(stop) = stops.next_if(|stop| *stop < t) {
                    reached.push(radau.within((stop - from) / span.h, &before));
                }
                allow(&mut scale, x, guard);
            }
        }
    }
    Ok(())
}

/// The first event of the step that was just accepted, as a part of it; the right side begins its next step at the end if there is none.
fn event(
    right_side: &mut ForcedRightSide,
    radau: &Radau,
    (from, h): (f64, f64),
    before: &[f64],
    end: &[f64],
) -> Result<Option<(f64, Vec<usize>)>, FaultKind> {
    if !right_side.has_switches() {
        return Ok(None);
    }
    let mut state_at = |_: &mut ForcedRightSide, part: f64| match part {
        0.0 => Ok(before.to_vec()),
        part => Ok(radau.within(part, before)),
    };
    match crossing(right_side, (from, h), end, &mut state_at)? {
        EventCrossing::Event { part, switches, .. } => Ok(Some((part, switches))),
        EventCrossing::Touches(part) => {
            // The polynomial tells what is between: one more look there is enough.
            let middle = radau.within(part, before);
            let found = crossing(right_side, (from, part * h), &middle, &mut |_, within| {
                Ok(radau.within(within * part, before))
            })?;
            if let EventCrossing::Event {
                part: p, switches, ..
            } = found
            {
                return Ok(Some((p * part, switches)));
            }
            right_side.begin_step(from + h, end).map(|()| None)
        }
        EventCrossing::Free => right_side.begin_step(from + h, end).map(|()| None),
    }
}

/// The allowed error of each component.
fn allow(scale: &mut [f64], x: &[f64], guard: &Guard) {
    for ((scale, x), size) in scale.iter_mut().zip(x).zip(&guard.sizes) {
        *scale = IMPLICIT.tolerance * (x.abs() + size);
    }
}

/// A first step, from the first and second derivative of the state: slope and J · slope.
fn first(jacobian: &[f64], slope: &[f64], scale: &[f64]) -> f64 {
    let rows = jacobian.chunks_exact(slope.len().max(1));
    let curvature: Vec<f64> = rows
        .map(|row| row.iter().zip(slope).map(|(j, s)| j * s).sum())
        .collect();
    let moves = IMPLICIT.tolerance * norm(slope, scale);
    let curvature = (IMPLICIT.tolerance * norm(&curvature, scale)).sqrt();
    IMPLICIT.first_step / moves.max(curvature).max(f64::MIN_POSITIVE)
}

/// Control of the step size.
#[derive(Clone, Copy, Debug)]
struct StepControl {
    /// The step that the last error suggests.
    h: f64,
    /// The step up to which the polynomial within it would be as exact as its end.
    interpolant_step: f64,
    /// The last accepted step, and its error.
    last_accepted: Option<(f64, f64)>,
    /// The last attempt failed.
    rejected: bool,
}

impl StepControl {
    fn new(h: f64) -> StepControl {
        StepControl {
            h,
            interpolant_step: h,
            last_accepted: None,
            rejected: false,
        }
    }

    /// True after a rejection and in the first step, where the error may be overestimated.
    fn error_is_uncertain(&self) -> bool {
        self.rejected || self.last_accepted.is_none()
    }

    fn shorten(&mut self, h: f64) {
        self.h = h;
        self.rejected = true;
    }

    /// The next step: to the next stop, or beyond it if the polynomial allows that.
    fn span(&self, t: f64, stop: f64, last: f64) -> Span {
        let (near, far) = (stop - t, last - t);
        let h = self.h.min(self.interpolant_step.max(near));
        // A step is stretched a little or halved, so that no tiny step is left before the end.
        let to = |end: f64, h: f64| Span { t, end, h };
        let ahead = if self.interpolant_step > near {
            far
        } else {
            near
        };
        let end = if ahead == far { last } else { stop };
        if h >= IMPLICIT.stretch * ahead {
            to(end, ahead)
        } else if h > 0.5 * ahead {
            to(t + 0.5 * ahead, 0.5 * ahead)
        } else {
            to(t + h, h)
        }
    }

    /// Whether a step is accepted; sets the length of the next one.
    fn judge(
        &mut self,
        h: f64,
        error: f64,
        (within, through): (f64, bool),
        iterations: usize,
    ) -> bool {
        self.interpolant_step =
            IMPLICIT.safety * h * within.max(IMPLICIT.error_rounding).powf(-ERROR_EXPONENT);
        let most = 2.0 * IMPLICIT.iterations as f64;
        let safety = IMPLICIT.safety * (most + 1.0) / (most + iterations as f64);
        let part = |error: f64, safety: f64| {
            (error.max(IMPLICIT.error_rounding).powf(ERROR_EXPONENT) / safety)
                .clamp(IMPLICIT.least_ratio, IMPLICIT.largest_ratio)
        };
        if error >= 1.0 {
            let part = part(error, safety);
            self.shorten(if self.last_accepted.is_none() {
                IMPLICIT.after_first * h
            } else {
                h / part
            });
            return false;
        }
        if through && within >= 1.0 {
            return false;
        }
        let mut next = h / part(error, safety);
        if let Some((last, last_error)) = self.last_accepted {
            // Errors that grow from step to step are expected to grow further (Gustafsson 1994).
            let trend = part(error * error / last_error, IMPLICIT.safety * h / last);
            next = next.min(h / trend);
        }
        if self.rejected {
            next = next.min(h);
        }
        if (1.0..IMPLICIT.kept_growth).contains(&(next / h)) {
            next = h;
        }
        // A step shortened by a stop is no reason for shorter steps.
        let cut = h < self.h && !self.rejected;
        self.h = if cut { next.max(self.h) } else { next };
        self.last_accepted = Some((h, error.max(IMPLICIT.trend_floor)));
        self.rejected = false;
        true
    }
}
