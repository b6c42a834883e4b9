//! From every sample to the next: where the laws lead, and how that answers to the state and to the coefficients.
//!
//! In: a record, states at its samples, coefficients. Out: blocks of intervals with end states, transitions T = ∂end/∂z and
//! coefficient columns U = ∂end/∂a. Classical Runge–Kutta of order four with as many steps as the laws are quick; T by the same
//! method on the variational equation, U by Simpson's rule over T. Held inputs jump at samples only, so no step crosses a jump.
//!
//! Intervals of a block lie beside each other, every quantity a row of all intervals, until they are handed out one by one.

use std::ops::Range;

use super::code::{Code, Diverged, Local, Scratch};
use super::columns::{Columns, follow, lay_out};
use super::record::Record;
use super::transition::{Transition, unit};
use crate::term::Tape;

/// Intervals worked on together.
pub(super) const BLOCK: usize = 64;
/// Most steps an interval.
const STEPS: usize = 64;
/// Error of a step of size s, relative to the state, is about s⁵/120.
const ERROR: f64 = 1.0 / 120.0;

/// What the flow needs besides a record.
pub(super) struct Flow<'a> {
    pub code: &'a Code,
    /// All candidate columns with the range of each law, where U is wanted for more than the active ones.
    pub all: Option<(&'a Tape, &'a [Range<usize>])>,
    /// Coefficients of the active columns.
    pub coefficients: &'a [f64],
    /// Size of each state, for the choice of steps.
    pub spread: &'a [f64],
    /// Largest error of an interval, relative to the spread.
    pub accuracy: f64,
}

/// Links of some intervals, one after another.
#[derive(Default)]
pub(super) struct Block {
    /// Where the flow ends, n each.
    pub end: Vec<f64>,
    /// T, n × n by rows each.
    pub transition: Vec<f64>,
    /// U, n × P by rows each.
    pub columns: Vec<f64>,
    /// Most steps that an interval took.
    pub steps: usize,
}

/// Scratch of a flow. Of three, the first belongs to the start of a step, then its middle, then its end.
#[derive(Default)]
pub(super) struct Work {
    scratch: Scratch,
    points: [Vec<f64>; 3],
    local: [Local; 3],
    /// Values of all columns.
    values: [Vec<f64>; 3],
    jacobians: [Vec<f64>; 3],
    /// What a unit of each law's right side there adds to the end: n × laws × intervals.
    gains: [Vec<f64>; 3],
    stage: Vec<f64>,
    rates: [Vec<f64>; 4],
    tape: Vec<f64>,
    /// Rates that the block before began with, laws × BLOCK.
    guess: Vec<f64>,
    transition: Transition,
    /// T so far.
    reached: Vec<f64>,
    moved: Vec<f64>,
}

/// Intervals of a record that take equally many steps.
struct Piece<'a> {
    record: &'a Record,
    /// Samples that they start at.
    intervals: Vec<usize>,
    /// Their places in the block.
    slots: Vec<usize>,
    /// Size of a step in each.
    h: Vec<f64>,
    steps: usize,
}

impl<'a> Piece<'a> {
    fn new(record: &'a Record, first: usize, slots: Vec<usize>, steps: usize) -> Self {
        let intervals: Vec<usize> = slots.iter().map(|b| first + b).collect();
        let length = |k: &usize| (record.time[k + 1] - record.time[*k]) / steps as f64;
        Piece {
            record,
            h: intervals.iter().map(length).collect(),
            intervals,
            slots,
            steps,
        }
    }

    fn count(&self) -> usize {
        self.h.len()
    }

    /// Where in the interval, from 0 to 1, a part of step `s` is.
    fn part(&self, s: usize, part: f64) -> f64 {
        (s as f64 + part) / self.steps as f64
    }
}

impl Flow<'_> {
    /// Number P of columns of U.
    pub fn width(&self) -> usize {
        match &self.all {
            Some((tape, _)) => tape.outputs(),
            None => self.code.active.len(),
        }
    }

    /// The intervals `from..to` (at most [`BLOCK`]); `states` has n numbers a sample.
    pub fn block(
        &self,
        record: &Record,
        states: &[f64],
        intervals: Range<usize>,
        work: &mut Work,
        out: &mut Block,
    ) -> Result<(), Diverged> {
        let (n, p, count) = (self.code.states, self.width(), intervals.len());
        out.columns.resize(count * n * p, 0.0);
        out.transition.resize(count * n * n, 0.0);
        out.end.resize(count * n, 0.0);
        let all = Piece::new(record, intervals.start, (0..count).collect(), 1);
        self.begin(&all, states, work)?;
        let steps = self.steps(&work.local[0], &all.h);
        out.steps = steps.iter().copied().max().unwrap_or(1);
        if out.steps == 1 {
            return self.run(&all, work, out);
        }
        let mut number = 1;
        while number <= out.steps {
            let slots: Vec<usize> = (0..count).filter(|b| steps[*b] == number).collect();
            if !slots.is_empty() {
                let piece = Piece::new(record, intervals.start, slots, number);
                self.begin(&piece, states, work)?;
                self.run(&piece, work, out)?;
            }
            number *= 2;
        }
        Ok(())
    }

    /// All steps of intervals that were begun.
    fn run(&self, piece: &Piece, work: &mut Work, out: &mut Block) -> Result<(), Diverged> {
        let (n, count) = (self.code.states, piece.count());
        work.reached.resize(n * n * count, 0.0);
        unit(&mut work.reached, n, count);
        for s in 0..piece.steps {
            self.step(piece, s, work)?;
            self.accumulate(piece, s, work, out);
            work.points.swap(0, 2);
            work.local.swap(0, 2);
            work.values.swap(0, 2);
        }
        let ends = &work.points[0][..n * count];
        lay_out(ends, &piece.slots, &mut out.end);
        lay_out(&work.reached, &piece.slots, &mut out.transition);
        Ok(())
    }

    /// States and rates at the start of the intervals.
    fn begin(&self, piece: &Piece, states: &[f64], work: &mut Work) -> Result<(), Diverged> {
        let (n, m, count) = (self.code.states, self.code.laws, piece.count());
        for points in &mut work.points {
            points.clear();
            points.resize(self.code.inputs * count, 0.0);
        }
        work.rates.iter_mut().for_each(|r| r.resize(n * count, 0.0));
        work.guess.resize(m * BLOCK, 0.0);
        let here = &mut work.points[0];
        for (b, (k, slot)) in piece.intervals.iter().zip(&piece.slots).enumerate() {
            (0..n).for_each(|i| here[i * count + b] = states[k * n + i]);
            (0..m).for_each(|l| here[(n + l) * count + b] = work.guess[l * BLOCK + slot]);
        }
        self.place(piece, 0.0, here);
        let (scratch, local) = (&mut work.scratch, &mut work.local[0]);
        self.code
            .evaluate(self.coefficients, here, count, scratch, local)?;
        for (b, slot) in piece.slots.iter().enumerate() {
            (0..m).for_each(|l| work.guess[l * BLOCK + slot] = here[(n + l) * count + b]);
        }
        if let Some((tape, _)) = self.all {
            values(tape, here, count, &mut work.values[0], &mut work.tape);
        }
        Ok(())
    }

    /// Outside signals, a part of the way along each interval.
    fn place(&self, piece: &Piece, part: f64, points: &mut [f64]) {
        let first = self.code.states + self.code.laws;
        let rows = points.chunks_exact_mut(piece.count()).skip(first);
        for (x, row) in rows.enumerate() {
            for (out, k) in row.iter_mut().zip(&piece.intervals) {
                *out = piece.record.outside_at(x, *k, part);
            }
        }
    }

    /// Steps of each interval of length `h`, a power of two.
    fn steps(&self, local: &Local, h: &[f64]) -> Vec<usize> {
        let (n, count) = (self.code.states, h.len());
        let largest = (self.accuracy / ERROR).powf(0.2);
        let steps = |(b, h): (usize, &f64)| {
            let mut norm = 0.0f64;
            for (l, i) in self.code.moved.iter().enumerate() {
                let row: f64 = (0..n)
                    .map(|j| local.jacobian[(l * n + j) * count + b].abs() * self.spread[j])
                    .sum();
                norm = norm.max(row / self.spread[*i]);
            }
            let wanted = (h * norm / largest).clamp(1.0, STEPS as f64);
            (wanted.ceil() as usize).next_power_of_two()
        };
        h.iter().enumerate().map(steps).collect()
    }

    /// One step of Runge–Kutta from where the rates are known already, and everything in its middle and at its end.
    fn step(&self, piece: &Piece, s: usize, work: &mut Work) -> Result<(), Diverged> {
        let (n, count) = (self.code.states, piece.count());
        let [here, middle, next] = &mut work.points;
        let (stage, rates) = (&mut work.stage, &mut work.rates);
        self.code.flow(here, count, &mut rates[0]);
        stage.clear();
        stage.extend_from_slice(here);
        for (r, reach) in [0.5, 0.5, 1.0].into_iter().enumerate() {
            let states = stage.chunks_exact_mut(count).take(n);
            let lines = here.chunks_exact(count).zip(rates[r].chunks_exact(count));
            for (out, (from, rate)) in states.zip(lines) {
                for (((out, x), rate), h) in out.iter_mut().zip(from).zip(rate).zip(&piece.h) {
                    *out = x + reach * h * rate;
                }
            }
            self.place(piece, piece.part(s, reach), stage);
            self.code
                .rates(self.coefficients, stage, count, &mut work.scratch)?;
            self.code.flow(stage, count, &mut rates[r + 1]);
        }
        // The last stage's rates are a good first guess at the end.
        next.copy_from_slice(stage);
        for i in 0..n {
            let row = i * count..(i + 1) * count;
            let [k1, k2, k3, k4] = rates.each_ref().map(|r| &r[row.clone()]);
            let out = next[row.clone()].iter_mut().zip(&here[row.clone()]);
            for (b, ((out, x), h)) in out.zip(&piece.h).enumerate() {
                *out = x + h / 6.0 * (k1[b] + 2.0 * (k2[b] + k3[b]) + k4[b]);
            }
        }
        if !next[..n * count].iter().all(|x| x.is_finite()) {
            return Err(Diverged);
        }
        let code = self.code;
        let (scratch, local) = (&mut work.scratch, &mut work.local);
        code.evaluate(self.coefficients, next, count, scratch, &mut local[2])?;
        // The state in the middle, from both ends and their rates (cubic Hermite).
        code.flow(next, count, &mut rates[1]);
        middle.copy_from_slice(next);
        for i in 0..n {
            let row = i * count..(i + 1) * count;
            let [k0, k1, from, to] =
                [&rates[0], &rates[1], &*here, &*next].map(|x| &x[row.clone()]);
            for (b, (out, h)) in middle[row.clone()].iter_mut().zip(&piece.h).enumerate() {
                *out = 0.5 * (from[b] + to[b]) + h / 8.0 * (k0[b] - k1[b]);
            }
        }
        self.place(piece, piece.part(s, 0.5), middle);
        code.evaluate(self.coefficients, middle, count, scratch, &mut local[1])?;
        if let Some((tape, _)) = self.all {
            values(tape, middle, count, &mut work.values[1], &mut work.tape);
            values(tape, next, count, &mut work.values[2], &mut work.tape);
        }
        Ok(())
    }

    /// T and U of one step, put behind those of the steps before.
    fn accumulate(&self, piece: &Piece, s: usize, work: &mut Work, out: &mut Block) {
        let (n, count) = (self.code.states, piece.count());
        for (jacobian, local) in work.jacobians.iter_mut().zip(&work.local) {
            self.jacobian(local, count, jacobian);
        }
        let jacobians = work.jacobians.each_ref().map(Vec::as_slice);
        work.transition.step(jacobians, &piece.h, n);
        if s > 0 {
            follow(
                &work.transition.whole,
                &piece.slots,
                (n, self.width()),
                &mut out.columns,
                &mut work.moved,
            );
        }
        work.transition.follow(&mut work.reached, n, count);
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
                &piece.h,
                &mut work.gains[node],
            );
        }
        let (values, ranges) = match self.all {
            Some((_, ranges)) => (work.values.each_ref().map(Vec::as_slice), ranges),
            None => (
                work.local.each_ref().map(|l| &l.columns[..]),
                &self.code.ranges[..],
            ),
        };
        let columns = Columns {
            gains: work.gains.each_ref().map(Vec::as_slice),
            values,
            laws: self.code.laws,
            slots: &piece.slots,
            n,
            p: self.width(),
        };
        columns.add(ranges, s > 0, &mut out.columns);
    }

    /// ∂z'/∂z, n × n × intervals.
    fn jacobian(&self, local: &Local, count: usize, out: &mut Vec<f64>) {
        let n = self.code.states;
        out.clear();
        out.resize(n * n * count, 0.0);
        for (i, next) in &self.code.chain {
            out[(i * n + next) * count..(i * n + next + 1) * count].fill(1.0);
        }
        for (l, i) in self.code.moved.iter().enumerate() {
            let row = &local.jacobian[l * n * count..(l + 1) * n * count];
            out[i * n * count..(i + 1) * n * count].copy_from_slice(row);
        }
    }

    /// What a unit of each law's right side at a node adds to the end state; without `to_end` the node is the end.
    fn gain(
        &self,
        local: &Local,
        to_end: Option<&[f64]>,
        weight: f64,
        h: &[f64],
        out: &mut Vec<f64>,
    ) {
        let (n, m, count) = (self.code.states, self.code.laws, h.len());
        out.clear();
        out.resize(n * m * count, 0.0);
        for (row, state) in self.code.moved.iter().enumerate() {
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

/// All columns at some points.
fn values(tape: &Tape, points: &[f64], count: usize, out: &mut Vec<f64>, work: &mut Vec<f64>) {
    out.resize(tape.outputs() * count, 0.0);
    tape.eval(points, count, out, work);
}
