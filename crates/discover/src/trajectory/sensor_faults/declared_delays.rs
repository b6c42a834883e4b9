//! Delays that are sought in a declared range: screened by integral matching, then estimated by profile likelihood.
//!
//! In: a problem without delays, delays with their ranges, a fit. Out: the delays under which the refitted likelihood is largest, each with
//! its 95 % confidence interval: where −2 log likelihood, everything else refitted, rises by 3.84 (Pawitan 2001, In All Likelihood, ch. 3).
//! Selects no terms.

use super::delay_screening::{columns, restricted};
use super::time_shift::step;
use crate::trajectory::golden_section::GoldenSection;
use crate::trajectory::likelihood::{Fit, PenalizedLikelihood, fit};
use crate::trajectory::model::{AppliedDelay, LinearizationPoint, Problem};
use crate::trajectory::search::{final_criterion, last_criterion};
use crate::trajectory::thresholds::{DECLARED_DELAYS, SEARCH};
use sidc_lang::term::VarId;
use sidc_progress::Observer;

/// A delay with what the likelihood says of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayEstimate {
    pub delay: AppliedDelay,
    /// 95 % confidence interval; an end of the range where the data do not bound the delay before it.
    pub interval: (f64, f64),
    /// Whether the likelihood is largest at an end of the range, and larger still beyond.
    pub at_end: bool,
}

impl DelayEstimate {
    /// Whether the data say nothing of the delay: its whole range is as likely.
    pub fn is_open(&self) -> bool {
        self.interval == self.delay.range && !self.at_end
    }
}

/// Ranges of delays with the value of each under which a few simple terms leave least. One delay is moved at a time.
pub fn screen_ranges(
    problem: &Problem,
    mut delays: Vec<AppliedDelay>,
    observer: &mut dyn Observer,
) -> Vec<AppliedDelay> {
    let own = |v: &VarId| problem.system.exogenous.iter().any(|s| s.var == *v);
    let inputs: Vec<VarId> = delays.iter().map(|d| d.var).filter(own).collect();
    let columns = columns(problem, &[], &inputs);
    let few = restricted(problem, &columns);
    let floor = final_criterion(problem).floor;
    let sigma: Vec<f64> = problem
        .noise
        .iter()
        .zip(&floor)
        .map(|(s, f)| s.max(*f))
        .collect();
    let left = |delays: &[AppliedDelay], observer: &mut dyn Observer| {
        let moved = few.with_delays(delays);
        let form = moved.integral_matching_form(&sigma, SEARCH.initial_slacks[0], observer)?;
        Some(form.least_squares(&(0..form.p).collect::<Vec<_>>()).square)
    };
    let sought: Vec<usize> = sought(&delays);
    let sweeps = if sought.len() > 1 {
        DECLARED_DELAYS.sweeps
    } else {
        1
    };
    for place in sought.iter().cycle().take(sweeps * sought.len()) {
        let mut best = (f64::INFINITY, delays[*place].seconds);
        for seconds in grid(problem, &delays[*place], DECLARED_DELAYS.screened) {
            delays[*place].seconds = seconds;
            if let Some(value) = left(&delays, observer).filter(|value| *value < best.0) {
                best = (value, seconds);
            }
        }
        delays[*place].seconds = best.1;
    }
    delays
}

/// Places of delays that are not known.
fn sought(delays: &[AppliedDelay]) -> Vec<usize> {
    let places = 0..delays.len();
    places
        .filter(|i| delays[*i].range.0 < delays[*i].range.1)
        .collect()
}

/// Delays evenly over a range, its ends among them: at most so many, none nearer than half a sampling interval.
fn grid(problem: &Problem, delay: &AppliedDelay, most: usize) -> Vec<f64> {
    let (from, to) = delay.range;
    let finest = step(problem).map_or(most as f64, |h| 2.0 * (to - from) / h);
    let parts = finest.ceil().clamp(2.0, most as f64);
    (0..=parts as usize)
        .map(|k| from + (to - from) * k as f64 / parts)
        .collect()
}

/// The delays under which the likelihood of the fitted support is largest. `at` is the problem with the delays as they are. `None` if the
/// observer ends the work.
pub fn profile_delays(
    problem: &Problem,
    delays: &[AppliedDelay],
    (at, found): (&Problem, &Fit),
    inefficiency: f64,
    observer: &mut dyn Observer,
) -> Option<Vec<DelayEstimate>> {
    let mut profile = DelayProfile {
        problem,
        delays: delays.to_vec(),
        criterion: last_criterion(at, inefficiency),
        best: (f64::INFINITY, at.clone(), found.point.clone()),
        rise: DECLARED_DELAYS.rise * inefficiency,
    };
    let sought = sought(delays);
    let sweeps = if sought.len() > 1 {
        DECLARED_DELAYS.sweeps
    } else {
        1
    };
    for place in sought.iter().cycle().take(sweeps * sought.len()) {
        profile.maximise(*place, observer);
    }
    let mut out = Vec::new();
    for place in 0..delays.len() {
        if !observer.go_on() {
            return None;
        }
        out.push(profile.estimate(place, observer));
    }
    Some(out)
}

/// The likelihood of one support as a function of delays.
struct DelayProfile<'a> {
    problem: &'a Problem,
    /// The best delays so far.
    delays: Vec<AppliedDelay>,
    criterion: PenalizedLikelihood,
    /// The criterion of the best fit, with its problem and point.
    best: (f64, Problem, LinearizationPoint),
    /// Rise of the criterion at the ends of an interval.
    rise: f64,
}

impl DelayProfile<'_> {
    /// The fit with one delay changed; `None` where nothing can be fitted.
    fn fit(
        &self,
        place: usize,
        seconds: f64,
        observer: &mut dyn Observer,
    ) -> Option<(Problem, Fit)> {
        let mut delays = self.delays.clone();
        delays[place].seconds = seconds;
        let problem = self.problem.with_delays(&delays);
        let start = self.best.2.on_instants(&self.best.1, &problem);
        if start.paths.len() != problem.records.len() {
            return None;
        }
        let found = fit(&problem, start, &self.criterion, f64::INFINITY, observer)?;
        Some((problem, found))
    }

    /// The criterion with one delay changed; infinite where nothing can be fitted. A better delay is kept.
    fn value(&mut self, place: usize, seconds: f64, observer: &mut dyn Observer) -> f64 {
        let Some((problem, fit)) = self.fit(place, seconds, observer) else {
            return f64::INFINITY;
        };
        if fit.value < self.best.0 {
            self.best = (fit.value, problem, fit.point);
            self.delays[place].seconds = seconds;
        }
        fit.value
    }

    /// Whether the likelihood rises further beyond an end of the range, tried at half a sampling interval and at `interval` beyond it.
    fn rises_beyond(
        &self,
        place: usize,
        end: f64,
        interval: f64,
        observer: &mut dyn Observer,
    ) -> bool {
        let (from, to) = self.delays[place].range;
        let outwards = if end == from { -1.0 } else { 1.0 };
        let near = step(self.problem).map_or(interval, |h| 0.5 * h);
        [near, interval].into_iter().any(|by| {
            let beyond = end + outwards * by.min(to - from);
            let found = self.fit(place, beyond, observer);
            found.is_some_and(|(_, fit)| fit.value < self.best.0 - self.rise)
        })
    }

    /// Moves one delay to the largest likelihood: over a grid, then by golden sections (Kiefer 1953) about the best of it.
    fn maximise(&mut self, place: usize, observer: &mut dyn Observer) {
        let delay = self.delays[place];
        self.value(place, delay.seconds, observer);
        let grid = grid(self.problem, &delay, DECLARED_DELAYS.profiled);
        for seconds in &grid {
            self.value(place, *seconds, observer);
        }
        let spacing = grid.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        let middle = self.delays[place].seconds;
        let bracket = (
            (middle - spacing).max(delay.range.0),
            (middle + spacing).min(delay.range.1),
        );
        let flat = DECLARED_DELAYS.flat * self.rise;
        let mut section = GoldenSection::new(bracket, &mut |at| self.value(place, at, observer));
        for _ in 0..DECLARED_DELAYS.sections {
            // The criterion no longer changes, but for the accuracy of the fits.
            if section.difference() < flat || !observer.go_on() {
                break;
            }
            section.narrow(&mut |at| self.value(place, at, observer));
        }
        self.move_to_vertex(place, section.bracket, observer);
    }

    /// The vertex of the parabola through the best delay and both ends of its bracket.
    fn move_to_vertex(
        &mut self,
        place: usize,
        (from, to): (f64, f64),
        observer: &mut dyn Observer,
    ) {
        let best = (self.delays[place].seconds, self.best.0);
        let ends = [from, to].map(|at| (at - best.0, self.value(place, at, observer) - best.1));
        let [(a, fa), (b, fb)] = ends;
        let curved = fa * b - fb * a;
        let vertex = best.0 + 0.5 * (fa * b * b - fb * a * a) / curved;
        if vertex.is_finite() && vertex > from && vertex < to {
            self.value(place, vertex, observer);
        }
    }

    fn estimate(&mut self, place: usize, observer: &mut dyn Observer) -> DelayEstimate {
        let delay = self.delays[place];
        let (from, to) = delay.range;
        if from >= to {
            return DelayEstimate {
                delay,
                interval: (from, to),
                at_end: false,
            };
        }
        let interval = (
            self.bound(place, from, observer),
            self.bound(place, to, observer),
        );
        let delay = self.delays[place];
        let interval = (interval.0.min(delay.seconds), interval.1.max(delay.seconds));
        let near = DECLARED_DELAYS.end * (to - from);
        let end = [from, to]
            .into_iter()
            .find(|end| (delay.seconds - end).abs() <= near);
        let width = interval.1 - interval.0;
        DelayEstimate {
            delay,
            interval,
            at_end: end.is_some_and(|end| self.rises_beyond(place, end, width, observer)),
        }
    }

    /// The end of the confidence interval towards `end`: where the criterion has risen by [`DelayProfile::rise`]; `end` itself if it has
    /// not. A bracketed secant method on the root of the rise, which is linear where the likelihood is Gaussian.
    fn bound(&mut self, place: usize, end: f64, observer: &mut dyn Observer) -> f64 {
        let best = self.delays[place].seconds;
        let length = end - best;
        if length == 0.0 {
            return end;
        }
        let least = self.best.0;
        let mut rise = |part: f64| {
            let value = self.value(place, best + part * length, observer);
            ((value - least) / self.rise).max(0.0)
        };
        if rise(1.0) < 1.0 {
            return end;
        }
        let (mut inside, mut outside) = (0.0, 1.0);
        let mut part = DECLARED_DELAYS.first_part;
        for _ in 0..DECLARED_DELAYS.bounds {
            let risen = rise(part);
            if (risen - 1.0).abs() < DECLARED_DELAYS.bound_accuracy {
                return best + part * length;
            }
            match risen < 1.0 {
                true => inside = part,
                false => outside = part,
            }
            let straight = part / risen.sqrt();
            let between = straight > inside && straight < outside;
            part = if between {
                straight
            } else {
                0.5 * (inside + outside)
            };
        }
        best + outside * length
    }
}
