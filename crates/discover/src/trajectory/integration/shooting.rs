//! Shooting from every sample to the next: the laws integrated, with sensitivities to the state and to the coefficients.
//!
//! In: a record, states at its samples, coefficients. Out: blocks of intervals with end states, transitions T = ∂end/∂z and
//! sensitivities U = ∂end/∂a. States and T by the classical Runge–Kutta method of order four, with as many steps as the laws are
//! fast; U by Simpson's rule over T (variation of constants). Held inputs jump at samples only, so no step crosses a jump.
//!
//! The intervals of a block are integrated side by side, every quantity a row over all intervals, and handed out one by one.

use std::ops::Range;

use super::compiled_laws::{CompiledLaws, Diverged, LocalLinearization};
use super::parameter_sensitivity::{INTERVALS_AT_ONCE, ParameterSensitivity, propagate, scatter};
use super::state_transition::unit;
use super::step_group::StepGroup;
use super::workspace::Workspace;
use crate::trajectory::model::Record;
use crate::trajectory::thresholds::SHOOTING;
use sidc_lang::term::Tape;

/// What integration needs besides a record.
pub(crate) struct ShootingIntegrator<'a> {
    pub laws: &'a CompiledLaws,
    /// All candidate columns with the range of each law; `None` where U is wanted for the active ones only.
    pub all: Option<(&'a Tape, &'a [Range<usize>])>,
    /// Coefficients of the active columns.
    pub coefficients: &'a [f64],
    /// Size of each state, for the choice of steps.
    pub spread: &'a [f64],
    /// Largest error of an interval, relative to the spread.
    pub accuracy: f64,
}

/// Results of some intervals, one after another.
#[derive(Default)]
pub(crate) struct IntervalBlock {
    /// End states, n each.
    pub end: Vec<f64>,
    /// T, n × n by rows each.
    pub transition: Vec<f64>,
    /// U, n × P by rows each.
    pub columns: Vec<f64>,
    /// Most steps that an interval took.
    pub steps: usize,
}

impl IntervalBlock {
    /// The intervals of another block after these.
    pub fn append(&mut self, next: &IntervalBlock) {
        self.end.extend_from_slice(&next.end);
        self.transition.extend_from_slice(&next.transition);
        self.columns.extend_from_slice(&next.columns);
        self.steps = self.steps.max(next.steps);
    }
}

impl ShootingIntegrator<'_> {
    /// Number P of columns of U.
    pub fn width(&self) -> usize {
        match &self.all {
            Some((tape, _)) => tape.outputs(),
            None => self.laws.active.len(),
        }
    }

    /// The laws with their coefficients.
    pub(super) fn weighted_laws(&self) -> (&CompiledLaws, &[f64]) {
        (self.laws, self.coefficients)
    }

    /// Integrates at most [`INTERVALS_AT_ONCE`] intervals; `states` has n numbers a sample.
    ///
    /// # Errors
    /// The laws diverge on some interval.
    pub fn block(
        &self,
        record: &Record,
        states: &[f64],
        intervals: Range<usize>,
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<(), Diverged> {
        let (n, p, count) = (self.laws.states, self.width(), intervals.len());
        out.columns.resize(count * n * p, 0.0);
        out.transition.resize(count * n * n, 0.0);
        out.end.resize(count * n, 0.0);
        let all = StepGroup::new(record, intervals.start, (0..count).collect(), 1);
        self.begin(&all, states, work)?;
        work.steps = self.steps(&work.local[0], &all.h)?;
        work.eventful.clear();
        let mut number = 1;
        if work.steps.iter().all(|s| *s == 1) {
            self.run(&all, states, work, out)?;
            number = 2;
        }
        // An interval that turns out to want more steps comes again.
        while number <= SHOOTING.max_steps {
            let slots: Vec<usize> = (0..count).filter(|b| work.steps[*b] == number).collect();
            if !slots.is_empty() {
                let group = StepGroup::new(record, intervals.start, slots, number);
                self.begin(&group, states, work)?;
                self.run(&group, states, work, out)?;
            }
            number *= 2;
        }
        out.steps = work.steps.iter().copied().max().unwrap_or(1);
        let eventful = std::mem::take(&mut work.eventful);
        let first = (record, intervals.start);
        for slot in self.along_guards(first, states, eventful, work, out) {
            let interval = (intervals.start + slot, slot);
            self.across_events((record, interval), states, work, out)?;
        }
        Ok(())
    }

    /// All steps, from where [`ShootingIntegrator::begin`] left off.
    fn run(
        &self,
        group: &StepGroup,
        states: &[f64],
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<(), Diverged> {
        let (n, count) = (self.laws.states, group.count());
        work.reached.resize(n * n * count, 0.0);
        unit(&mut work.reached, n, count);
        self.note_late_starts(group, work);
        for s in 0..group.steps {
            self.advance(group, s, work)?;
            self.linearise_step(group, s, work)?;
            self.note_events(group, work);
            self.note_faster(group, work);
            self.accumulate(group, s > 0, work, out);
        }
        self.note_missed_jumps(group, states, work);
        let ends = &work.points[0][..n * count];
        scatter(ends, &group.slots, &mut out.end);
        scatter(&work.reached, &group.slots, &mut out.transition);
        Ok(())
    }

    /// Sets states and signals at the start of the intervals, and first guesses of the rates.
    pub(super) fn place(&self, group: &StepGroup, states: &[f64], work: &mut Workspace) {
        let (n, m, count) = (self.laws.states, self.laws.laws, group.count());
        for points in &mut work.points {
            points.clear();
            points.resize(self.laws.inputs * count, 0.0);
        }
        work.rates.iter_mut().for_each(|r| r.resize(n * count, 0.0));
        work.guess.resize(m * INTERVALS_AT_ONCE, 0.0);
        let here = &mut work.points[0];
        for (b, (k, slot)) in group.intervals.iter().zip(&group.slots).enumerate() {
            (0..n).for_each(|i| here[i * count + b] = states[k * n + i]);
            (0..m)
                .for_each(|l| here[(n + l) * count + b] = work.guess[l * INTERVALS_AT_ONCE + slot]);
        }
        self.set_exogenous(group, 0.0, here);
        if let Some(switches) = &self.laws.switches {
            switches.set_sides(here, count);
        }
    }

    /// Sets states and rates at the start of the intervals.
    fn begin(
        &self,
        group: &StepGroup,
        states: &[f64],
        work: &mut Workspace,
    ) -> Result<(), Diverged> {
        self.place(group, states, work);
        let (n, m, count) = (self.laws.states, self.laws.laws, group.count());
        let here = &mut work.points[0];
        let (scratch, local) = (&mut work.scratch, &mut work.local[0]);
        self.laws
            .evaluate(self.coefficients, here, count, scratch, local)?;
        for (b, slot) in group.slots.iter().enumerate() {
            (0..m)
                .for_each(|l| work.guess[l * INTERVALS_AT_ONCE + slot] = here[(n + l) * count + b]);
        }
        if let Some((tape, _)) = self.all {
            values(tape, here, count, &mut work.values[0], &mut work.tape);
        }
        Ok(())
    }

    /// Sets the exogenous signals at a position in each interval.
    pub(super) fn set_exogenous(&self, group: &StepGroup, part: f64, points: &mut [f64]) {
        let first = self.laws.states + self.laws.laws;
        let rows = points.chunks_exact_mut(group.count()).skip(first);
        for (x, row) in rows.enumerate().take(group.record.exogenous.len()) {
            for (out, k) in row.iter_mut().zip(&group.intervals) {
                *out = group.record.exogenous_at(x, *k, part);
            }
        }
    }

    /// One Runge–Kutta step from a point where the rates are known.
    pub(super) fn advance(
        &self,
        group: &StepGroup,
        s: usize,
        work: &mut Workspace,
    ) -> Result<(), Diverged> {
        let (n, count) = (self.laws.states, group.count());
        let [here, _, next] = &mut work.points;
        let (stage, rates) = (&mut work.stage, &mut work.rates);
        let laws = self.weighted_laws();
        self.laws.flow(here, count, &mut rates[0]);
        stage.clear();
        stage.extend_from_slice(here);
        for (r, reach) in [0.5, 0.5, 1.0].into_iter().enumerate() {
            let states = stage.chunks_exact_mut(count).take(n);
            let lines = here.chunks_exact(count).zip(rates[r].chunks_exact(count));
            for (out, (from, rate)) in states.zip(lines) {
                for (((out, x), rate), h) in out.iter_mut().zip(from).zip(rate).zip(&group.h) {
                    *out = x + reach * h * rate;
                }
            }
            self.set_exogenous(group, group.part(s, reach), stage);
            let (part, scratch) = (group.part(s, reach), &mut work.scratch);
            match group.sliding.is_empty() {
                true => (self.laws).rates(self.coefficients, stage, count, scratch)?,
                false => work.sliding.hold(laws, (group, part), stage, scratch)?,
            }
            self.laws.flow(stage, count, &mut rates[r + 1]);
        }
        // The rates of the last stage are a good first guess for implicit laws at the end.
        next.copy_from_slice(stage);
        for i in 0..n {
            let row = i * count..(i + 1) * count;
            let [k1, k2, k3, k4] = rates.each_ref().map(|r| &r[row.clone()]);
            let out = next[row.clone()].iter_mut().zip(&here[row.clone()]);
            for (b, ((out, x), h)) in out.zip(&group.h).enumerate() {
                *out = x + h / 6.0 * (k1[b] + 2.0 * (k2[b] + k3[b]) + k4[b]);
            }
        }
        if !next[..n * count].iter().all(|x| x.is_finite()) {
            return Err(Diverged);
        }
        Ok(())
    }

    /// The laws linearised in the middle and at the end of a step.
    pub(super) fn linearise_step(
        &self,
        group: &StepGroup,
        s: usize,
        work: &mut Workspace,
    ) -> Result<(), Diverged> {
        let (n, count, laws) = (self.laws.states, group.count(), self.laws);
        let [here, middle, next] = &mut work.points;
        let (scratch, local, rates) = (&mut work.scratch, &mut work.local, &mut work.rates);
        let (flow, end) = (&mut work.sliding, group.part(s, 1.0));
        flow.linearise(
            self.weighted_laws(),
            (group, end),
            next,
            (scratch, &mut local[2]),
        )?;
        // The middle state by cubic Hermite interpolation.
        laws.flow(next, count, &mut rates[1]);
        middle.copy_from_slice(next);
        for i in 0..n {
            let row = i * count..(i + 1) * count;
            let [k0, k1, from, to] =
                [&rates[0], &rates[1], &*here, &*next].map(|x| &x[row.clone()]);
            for (b, (out, h)) in middle[row.clone()].iter_mut().zip(&group.h).enumerate() {
                *out = 0.5 * (from[b] + to[b]) + h / 8.0 * (k0[b] - k1[b]);
            }
        }
        self.set_exogenous(group, group.part(s, 0.5), middle);
        let half = group.part(s, 0.5);
        flow.linearise(
            self.weighted_laws(),
            (group, half),
            middle,
            (scratch, &mut local[1]),
        )?;
        if let Some((tape, _)) = self.all {
            values(tape, middle, count, &mut work.values[1], &mut work.tape);
            values(tape, next, count, &mut work.values[2], &mut work.tape);
        }
        Ok(())
    }

    /// Composes T and U of one step with those of the steps before it, `onto` which U is added, and moves on to its end.
    pub(super) fn accumulate(
        &self,
        group: &StepGroup,
        onto: bool,
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) {
        let (n, count) = (self.laws.states, group.count());
        for (jacobian, local) in work.jacobians.iter_mut().zip(&work.local) {
            self.jacobian(local, count, jacobian);
        }
        let jacobians = work.jacobians.each_ref().map(Vec::as_slice);
        work.transition.step(jacobians, &group.h, n);
        if onto {
            propagate(
                &work.transition.whole,
                &group.slots,
                (n, self.width()),
                &mut out.columns,
                &mut work.moved,
            );
        }
        work.transition.compose(&mut work.reached, n, count);
        let to_end = [
            Some(&work.transition.whole),
            Some(&work.transition.half),
            None,
        ];
        for (node, (to_end, weight)) in to_end.into_iter().zip([1.0, 4.0, 1.0]).enumerate() {
            let to_end = to_end.map(Vec::as_slice);
            self.gain(
                &work.local[node],
                to_end,
                weight / 6.0,
                &group.h,
                &mut work.gains[node],
            );
        }
        let (values, ranges) = match self.all {
            Some((_, ranges)) => (work.values.each_ref().map(Vec::as_slice), ranges),
            None => (
                work.local.each_ref().map(|l| &l.columns[..]),
                &self.laws.ranges[..],
            ),
        };
        let columns = ParameterSensitivity {
            gains: work.gains.each_ref().map(Vec::as_slice),
            values,
            laws: self.laws.laws,
            slots: &group.slots,
            n,
            p: self.width(),
        };
        columns.add(ranges, onto, &mut out.columns);
        work.points.swap(0, 2);
        work.local.swap(0, 2);
        work.values.swap(0, 2);
    }

    /// The Jacobian ∂z'/∂z, n × n × intervals.
    fn jacobian(&self, local: &LocalLinearization, count: usize, out: &mut Vec<f64>) {
        let n = self.laws.states;
        out.clear();
        out.resize(n * n * count, 0.0);
        for (i, next) in &self.laws.chain {
            out[(i * n + next) * count..(i * n + next + 1) * count].fill(1.0);
        }
        for (l, i) in self.laws.law_states.iter().enumerate() {
            let row = &local.jacobian[l * n * count..(l + 1) * n * count];
            out[i * n * count..(i + 1) * n * count].copy_from_slice(row);
        }
    }

    /// What a unit of each law's right side at a node adds to the end state. `to_end` is the transition from the node to the end, `None`
    /// at the end itself.
    pub(super) fn gain(
        &self,
        local: &LocalLinearization,
        to_end: Option<&[f64]>,
        weight: f64,
        h: &[f64],
        out: &mut Vec<f64>,
    ) {
        let (n, m, count) = (self.laws.states, self.laws.laws, h.len());
        out.clear();
        out.resize(n * m * count, 0.0);
        for (row, state) in self.laws.law_states.iter().enumerate() {
            for i in 0..n {
                let reach =
                    to_end.map(|t| &t[(i * n + state) * count..(i * n + state + 1) * count]);
                if reach.is_none() && i != *state {
                    continue;
                }
                let at = |b: usize| weight * h[b] * reach.map_or(1.0, |r| r[b]);
                if local.solved.is_empty() {
                    let out = &mut out[(i * m + row) * count..(i * m + row + 1) * count];
                    out.iter_mut().enumerate().for_each(|(b, x)| *x += at(b));
                    continue;
                }
                for l in 0..m {
                    let solved = &local.solved[(row * m + l) * count..(row * m + l + 1) * count];
                    let out = &mut out[(i * m + l) * count..(i * m + l + 1) * count];
                    for (b, (x, solved)) in out.iter_mut().zip(solved).enumerate() {
                        *x += at(b) * solved;
                    }
                }
            }
        }
    }
}

/// Evaluates all columns at some points.
pub(super) fn values(
    tape: &Tape,
    points: &[f64],
    count: usize,
    out: &mut Vec<f64>,
    work: &mut Vec<f64>,
) {
    out.resize(tape.outputs() * count, 0.0);
    tape.eval(points, count, out, work);
}
