//! Explicit Runge–Kutta methods: Dormand–Prince 5(4) with error control, and the classical method with fixed steps.
//!
//! In: a right side, a state, an instant to reach. Out: the state there, or that the right side is stiff, or where and why
//! integration ended.
//! Dormand, Prince 1980 (J. Comp. Appl. Math. 6); step control and stiffness test as in Hairer, Nørsett, Wanner,
//! Solving Ordinary Differential Equations I, II.4, and II, IV.2.

use crate::simulate::fault::FaultKind;
use crate::simulate::forced_right_side::{Ended, ForcedRightSide, Guard};
use crate::simulate::integrate::event_crossing::{EventCrossing, crossing};
use crate::simulate::thresholds::EXPLICIT;

/// Nodes and weights of the Dormand–Prince tableau (c and A), stage by stage.
const STAGES: [(f64, &[f64]); 7] = [
    (0.0, &[]),
    (0.2, &[0.2]),
    (0.3, &[3.0 / 40.0, 9.0 / 40.0]),
    (0.8, &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0]),
    (
        8.0 / 9.0,
        &[
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
        ],
    ),
    (
        1.0,
        &[
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
        ],
    ),
    (
        1.0,
        &[
            35.0 / 384.0,
            0.0,
            500.0 / 1113.0,
            125.0 / 192.0,
            -2187.0 / 6784.0,
            11.0 / 84.0,
        ],
    ),
];
/// Weights of the 5th order minus those of the 4th.
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// Where integration stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reached {
    Stop,
    /// Stopped at this instant: an implicit method is needed from here on.
    Stiff(f64),
}

/// State of the method between steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct RungeKutta {
    /// The step size to try next; 0 before the first step.
    h: f64,
    /// Slopes of every component at all stages.
    slopes: Vec<[f64; 7]>,
    /// Slopes at the present stage.
    rates: Vec<f64>,
    stage: Vec<f64>,
    end: Vec<f64>,
    /// True if the slopes of the first stage belong to the present state and inputs.
    fresh: bool,
}

impl RungeKutta {
    pub fn new(n: usize) -> RungeKutta {
        RungeKutta {
            slopes: vec![[0.0; 7]; n],
            rates: vec![0.0; n],
            stage: vec![0.0; n],
            end: vec![0.0; n],
            ..RungeKutta::default()
        }
    }

    /// To be called when the inputs or the state were changed from outside.
    pub fn restart(&mut self) {
        self.fresh = false;
    }

    /// Integrates from `t` to `stop` with error control. With `watch` it also tests for stiffness.
    pub fn advance(
        &mut self,
        right_side: &mut ForcedRightSide,
        (mut t, stop): (f64, f64),
        x: &mut [f64],
        guard: &mut Guard,
        watch: bool,
    ) -> Result<Reached, Ended> {
        let (mut limits, mut calm, mut steps) = (0, 0, 0);
        let mut failed = None;
        if self.h == 0.0 {
            self.first_step(right_side, (t, stop), x, guard)?;
        }
        while t < stop {
            let smallest = EXPLICIT.smallest_step * t.abs().max(stop.abs());
            // The last step is stretched a little rather than leaving a sliver, which an event just before the stop may leave.
            let left = stop - t;
            if left <= smallest {
                break;
            }
            let last = self.h >= 0.999 * left;
            let (h, end) = match last {
                true => (left, stop),
                false => (self.h, t + self.h),
            };
            if h <= smallest {
                return Err((failed.unwrap_or(FaultKind::StepTooSmall), t));
            }
            steps += 1;
            guard.check(t, x, right_side.work.calls)?;
            let error = match self.attempt(right_side, (t, end), x, h, guard) {
                Ok(error) => error,
                Err(kind) => {
                    // A trial step may leave the domain of the equations; a shorter one may not.
                    failed = Some(kind);
                    self.h = 0.25 * h;
                    continue;
                }
            };
            let factor = EXPLICIT.safety * error.max(1e-12).powf(-0.2);
            if error > 1.0 {
                self.h = h * factor.clamp(EXPLICIT.shrinks, 1.0);
                continue;
            }
            failed = None;
            if right_side.has_switches() {
                match self
                    .crossing(right_side, (t, h), x, guard)
                    .map_err(|kind| (kind, t))?
                {
                    EventCrossing::Free => right_side
                        .begin_step(end, &self.end)
                        .map_err(|kind| (kind, end))?,
                    EventCrossing::Touches(part) => {
                        self.h = part * h;
                        continue;
                    }
                    EventCrossing::Event {
                        part,
                        state,
                        switches,
                    } => {
                        let there = self.end.clone();
                        x.copy_from_slice(&state);
                        t = if part == 1.0 { end } else { t + part * h };
                        right_side
                            .pass_event((t, x), &guard.sizes, (part, &switches, &there))
                            .map_err(|kind| (kind, t))?;
                        self.fresh = false;
                        continue;
                    }
                }
            }
            if watch {
                let stiff = self.stretch(h, guard) > EXPLICIT.stability;
                // At the limit of stability step sizes oscillate, so a single calm step does not count.
                calm = if stiff { 0 } else { calm + 1 };
                limits = match stiff {
                    true => limits + 1,
                    false if calm >= EXPLICIT.calm_steps => 0,
                    false => limits,
                };
            }
            x.copy_from_slice(&self.end);
            self.slopes.iter_mut().for_each(|k| k.swap(0, 6));
            t = end;
            // A step shortened by the stop is no reason for shorter steps.
            let next = h * factor.min(EXPLICIT.grows);
            self.h = if last { next.max(self.h) } else { next };
            if watch
                && t < stop
                && (limits >= EXPLICIT.stiff_steps || steps > EXPLICIT.steps_between_stops)
            {
                return Ok(Reached::Stiff(t));
            }
        }
        guard.check(t, x, right_side.work.calls)?;
        Ok(Reached::Stop)
    }

    /// What the step that was just tried passes. The state at its end stays in `end`.
    fn crossing(
        &mut self,
        right_side: &mut ForcedRightSide,
        (t, h): (f64, f64),
        x: &[f64],
        guard: &Guard,
    ) -> Result<EventCrossing, FaultKind> {
        let end = self.end.clone();
        let slopes = self.slopes.clone();
        let mut state_at = |right_side: &mut ForcedRightSide, part: f64| match part {
            0.0 => Ok(x.to_vec()),
            part => {
                self.attempt(right_side, (t, t + part * h), x, part * h, guard)?;
                Ok(self.end.clone())
            }
        };
        let found = crossing(right_side, (t, h), &end, &mut state_at);
        self.end = end;
        self.slopes = slopes;
        found
    }

    /// Integrates from `t` to `stop` in equal steps of at most `h` of the classical method.
    pub fn fixed(
        &mut self,
        right_side: &mut ForcedRightSide,
        (t, stop): (f64, f64),
        x: &mut [f64],
        guard: &mut Guard,
        h: f64,
    ) -> Result<(), Ended> {
        // Rounding of the quotient must not add a step.
        let count = ((stop - t) / h - 1e-6).ceil().max(1.0);
        let h = (stop - t) / count;
        let mut k = 0.0;
        while k < count {
            let at = t + k * h;
            guard.check(at, x, right_side.work.calls)?;
            match right_side.has_switches() {
                false => self.classical(right_side, at, x, h),
                true => self.classical_between_events(right_side, at, x, (h, guard)),
            }
            .map_err(|kind| (kind, at))?;
            k += 1.0;
        }
        guard.check(stop, x, right_side.work.calls)
    }

    /// One fixed step, cut at the events within it.
    fn classical_between_events(
        &mut self,
        right_side: &mut ForcedRightSide,
        t: f64,
        x: &mut [f64],
        (h, guard): (f64, &Guard),
    ) -> Result<(), FaultKind> {
        let mut done = 0.0;
        while done < 1.0 {
            let (from, left) = (t + done * h, (1.0 - done) * h);
            let start = x.to_vec();
            self.classical(right_side, from, x, left)?;
            let end = x.to_vec();
            let mut state_at = |right_side: &mut ForcedRightSide, part: f64| {
                let mut state = start.clone();
                if part > 0.0 {
                    self.classical(right_side, from, &mut state, part * left)?;
                }
                Ok(state)
            };
            match crossing(right_side, (from, left), &end, &mut state_at)? {
                EventCrossing::Free | EventCrossing::Touches(_) => {
                    right_side.begin_step(from + left, &end)?;
                    done = 1.0;
                }
                EventCrossing::Event {
                    part,
                    state,
                    switches,
                } => {
                    x.copy_from_slice(&state);
                    done += part * (1.0 - done);
                    let at = t + done * h;
                    right_side.pass_event((at, x), &guard.sizes, (part, &switches, &end))?;
                }
            }
        }
        Ok(())
    }

    /// Chooses a first step over which the state changes by a hundredth of its size.
    fn first_step(
        &mut self,
        right_side: &mut ForcedRightSide,
        (t, stop): (f64, f64),
        x: &[f64],
        guard: &Guard,
    ) -> Result<(), Ended> {
        right_side
            .rates(t, x, &mut self.rates)
            .map_err(|kind| (kind, t))?;
        let sizes = x.iter().zip(&guard.sizes).map(|(x, s)| x.abs() + s);
        let moves = self.rates.iter().zip(sizes).map(|(k, s)| k.abs() / s);
        let fastest = moves.fold(0.0, f64::max);
        self.h = f64::min(stop - t, 0.01 / fastest.max(1e-300));
        Ok(())
    }

    /// One step of size h from x to `end`. Returns its error estimate, scaled so that 1 is allowed.
    fn attempt(
        &mut self,
        right_side: &mut ForcedRightSide,
        (t, end): (f64, f64),
        x: &[f64],
        h: f64,
        guard: &Guard,
    ) -> Result<f64, FaultKind> {
        if !self.fresh {
            right_side.rates(t, x, &mut self.rates)?;
            self.keep(0);
            self.fresh = true;
        }
        for (stage, (node, weights)) in STAGES.iter().enumerate().skip(1) {
            // The last two stages are kept: they estimate the largest eigenvalue.
            let target = match stage {
                6 => &mut self.end,
                _ => &mut self.stage,
            };
            for ((z, x), k) in target.iter_mut().zip(x).zip(&self.slopes) {
                *z = x + h * dot(k, weights);
            }
            // The last stage ends exactly where the next step begins.
            let at = if *node == 1.0 { end } else { t + node * h };
            right_side.rates(at, target, &mut self.rates)?;
            self.keep(stage);
        }
        let mut square = 0.0;
        let states = x.iter().zip(&self.end).zip(&guard.sizes);
        for (((x, end), size), k) in states.zip(&self.slopes) {
            let scale = guard.tolerance * (size + x.abs().max(end.abs()));
            square += (h * dot(k, &ERROR) / scale).powi(2);
        }
        let error = (square / x.len().max(1) as f64).sqrt();
        // A step that is not a number is rejected.
        Ok(if error.is_nan() { f64::INFINITY } else { error })
    }

    /// Stores the rates as the slopes of this stage.
    fn keep(&mut self, stage: usize) {
        for (k, rate) in self.slopes.iter_mut().zip(&self.rates) {
            k[stage] = *rate;
        }
    }

    /// Estimates h·|λ| of the largest eigenvalue from the last two stages (Hairer, Wanner II, IV.2).
    fn stretch(&self, h: f64, guard: &Guard) -> f64 {
        let (mut rates, mut states) = (0.0, 0.0);
        let stages = self.end.iter().zip(&self.stage).zip(&self.slopes);
        for (((end, stage), k), size) in stages.zip(&guard.sizes) {
            rates += ((k[6] - k[5]) / size).powi(2);
            // At tight tolerances slow components differ by rounding only.
            let rounding = 4.0 * f64::EPSILON * end.abs();
            let moved = (end - stage).abs() - rounding;
            states += (moved.max(0.0) / size).powi(2);
        }
        if states > 0.0 {
            h * f64::sqrt(rates / states)
        } else {
            0.0
        }
    }

    fn classical(
        &mut self,
        right_side: &mut ForcedRightSide,
        t: f64,
        x: &mut [f64],
        h: f64,
    ) -> Result<(), FaultKind> {
        right_side.rates(t, x, &mut self.rates)?;
        self.keep(0);
        for (stage, part) in [(1, 0.5), (2, 0.5), (3, 1.0)] {
            for ((z, x), k) in self.stage.iter_mut().zip(&*x).zip(&self.rates) {
                *z = x + part * h * k;
            }
            right_side.rates(t + part * h, &self.stage, &mut self.rates)?;
            self.keep(stage);
        }
        for (x, k) in x.iter_mut().zip(&self.slopes) {
            *x += h / 6.0 * (k[0] + 2.0 * (k[1] + k[2]) + k[3]);
        }
        Ok(())
    }
}

#[inline]
fn dot(slopes: &[f64; 7], weights: &[f64]) -> f64 {
    slopes.iter().zip(weights).map(|(k, w)| k * w).sum()
}
