//! From every sample to the next: where the laws lead, and how that answers to the state and to the coefficients.
//!
//! In: a record, states at its samples, coefficients. Out: blocks of intervals with end states, transitions T = ∂end/∂z and
//! coefficient columns U = ∂end/∂a. Classical Runge–Kutta of order four with as many steps as the laws are quick; T by the same
//! method on the variational equation, U by Simpson's rule over T. Held inputs jump at samples only, so no step crosses a jump.

use std::ops::Range;

use super::code::{Code, Diverged, Local, Scratch};
use super::dense::multiply;
use super::record::Record;
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

/// Scratch of a flow.
#[derive(Default)]
pub(super) struct Work {
    scratch: Scratch,
    points: [Vec<f64>; 3],
    stage: Vec<f64>,
    local: [Local; 3],
    rates: [Vec<f64>; 4],
    all: Vec<f64>,
    tape: Vec<f64>,
    guess: Vec<f64>,
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
        let (n, count) = (self.code.states, intervals.len());
        let p = self.width();
        let steps_h: Vec<f64> = intervals
            .clone()
            .map(|k| record.time[k + 1] - record.time[k])
            .collect();
        let rows = self.code.inputs * count;
        work.points.iter_mut().for_each(|x| {
            x.clear();
            x.resize(rows, 0.0);
        });
        let m = self.code.laws;
        if work.guess.len() != m * count {
            work.guess = vec![0.0; m * count];
        }
        let [here, middle, next] = &mut work.points;
        for i in 0..n {
            for (b, k) in intervals.clone().enumerate() {
                here[i * count + b] = states[k * n + i];
            }
        }
        here[n * count..(n + m) * count].copy_from_slice(&work.guess);
        self.place(record, &intervals, 0.0, here);
        self.evaluate(here, count, &mut work.scratch, &mut work.local[0])?;
        work.guess
            .copy_from_slice(&here[n * count..(n + m) * count]);
        let steps = self.steps(&work.local[0], &steps_h);
        out.steps = steps;
        identity(&mut out.transition, n, count);
        out.columns.clear();
        out.columns.resize(count * n * p, 0.0);
        let h: Vec<f64> = steps_h.iter().map(|h| h / steps as f64).collect();
        for s in 0..steps {
            let part = |x: f64| (s as f64 + x) / steps as f64;
            self.step(
                record,
                &intervals,
                &h,
                part(0.5),
                part(1.0),
                [here, middle, next],
                &mut work.stage,
                &mut work.rates,
                &mut work.scratch,
            )?;
            self.evaluate(next, count, &mut work.scratch, &mut work.local[2])?;
            self.halfway(here, next, &h, &mut work.rates, middle, count);
            self.place(record, &intervals, part(0.5), middle);
            self.evaluate(middle, count, &mut work.scratch, &mut work.local[1])?;
            self.accumulate(
                &h,
                [here, middle, next],
                &work.local,
                &mut work.all,
                &mut work.tape,
                out,
            );
            std::mem::swap(here, next);
            work.local.swap(0, 2);
        }
        out.end.clear();
        for b in 0..count {
            out.end.extend((0..n).map(|i| here[i * count + b]));
        }
        Ok(())
    }

    fn evaluate(
        &self,
        points: &mut [f64],
        count: usize,
        scratch: &mut Scratch,
        local: &mut Local,
    ) -> Result<(), Diverged> {
        self.code.rates(self.coefficients, points, count, scratch)?;
        self.code
            .linearise(self.coefficients, points, count, scratch, local)
    }

    /// Outside signals, a part of the way along each interval.
    fn place(&self, record: &Record, intervals: &Range<usize>, part: f64, points: &mut [f64]) {
        let (first, count) = (self.code.states + self.code.laws, intervals.len());
        for x in 0..self.code.inputs - first {
            for (b, k) in intervals.clone().enumerate() {
                points[(first + x) * count + b] = record.outside_at(x, k, part);
            }
        }
    }

    /// Steps an interval, for the quickest of the block.
    fn steps(&self, local: &Local, h: &[f64]) -> usize {
        let (n, count) = (self.code.states, h.len());
        let largest = (self.accuracy / ERROR).powf(0.2);
        let mut most = 1.0f64;
        for (b, h) in h.iter().enumerate() {
            let mut norm = 0.0f64;
            for (l, i) in self.code.moved.iter().enumerate() {
                let row: f64 = (0..n)
                    .map(|j| local.jacobian[(l * n + j) * count + b].abs() * self.spread[j])
                    .sum();
                norm = norm.max(row / self.spread[*i]);
            }
            most = most.max(h * norm / largest);
        }
        (most.min(STEPS as f64).ceil() as usize).next_power_of_two()
    }

    /// `here` → `next` by Runge–Kutta; the rates at `here` are there already.
    #[allow(clippy::too_many_arguments)]
    fn step(
        &self,
        record: &Record,
        intervals: &Range<usize>,
        h: &[f64],
        mid: f64,
        end: f64,
        [here, _, next]: [&mut Vec<f64>; 3],
        stage: &mut Vec<f64>,
        rates: &mut [Vec<f64>; 4],
        scratch: &mut Scratch,
    ) -> Result<(), Diverged> {
        let (n, m, count) = (self.code.states, self.code.laws, h.len());
        rates.iter_mut().for_each(|r| r.resize(n * count, 0.0));
        self.code.flow(here, count, &mut rates[0]);
        stage.clear();
        stage.extend_from_slice(here);
        for (s, (reach, part)) in [(0.5, mid), (0.5, mid), (1.0, end)].iter().enumerate() {
            for i in 0..n {
                for (b, h) in h.iter().enumerate() {
                    let at = i * count + b;
                    stage[at] = here[at] + reach * h * rates[s][at];
                }
            }
            self.place(record, intervals, *part, stage);
            self.code.rates(self.coefficients, stage, count, scratch)?;
            self.code.flow(stage, count, &mut rates[s + 1]);
        }
        next.copy_from_slice(stage);
        for at in 0..n * count {
            let b = at % count;
            let sum = rates[0][at] + 2.0 * (rates[1][at] + rates[2][at]) + rates[3][at];
            next[at] = here[at] + h[b] / 6.0 * sum;
            if !next[at].is_finite() {
                return Err(Diverged);
            }
        }
        // The last stage's rates are a good first guess there.
        next[n * count..(n + m) * count].copy_from_slice(&stage[n * count..(n + m) * count]);
        Ok(())
    }

    /// The state in the middle, from both ends and their rates (cubic Hermite).
    fn halfway(
        &self,
        here: &[f64],
        next: &[f64],
        h: &[f64],
        rates: &mut [Vec<f64>; 4],
        middle: &mut [f64],
        count: usize,
    ) {
        let n = self.code.states;
        self.code.flow(here, count, &mut rates[0]);
        self.code.flow(next, count, &mut rates[1]);
        middle.copy_from_slice(next);
        for at in 0..n * count {
            let bend = h[at % count] / 8.0 * (rates[0][at] - rates[1][at]);
            middle[at] = 0.5 * (here[at] + next[at]) + bend;
        }
    }

    /// T and U of one step, put behind those of the steps before.
    fn accumulate(
        &self,
        h: &[f64],
        points: [&mut Vec<f64>; 3],
        local: &[Local; 3],
        all: &mut Vec<f64>,
        tape: &mut Vec<f64>,
        out: &mut Block,
    ) {
        let (n, count, p) = (self.code.states, h.len(), self.width());
        let nn = n * n;
        let mut j: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; nn]);
        let mut t: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; nn]);
        let mut temp = vec![0.0; nn];
        if let Some((code, _)) = self.all {
            all.resize(3 * p * count, 0.0);
            for (points, values) in points.iter().zip(all.chunks_exact_mut(p * count)) {
                code.eval(points, count, values, tape);
            }
        }
        let mut moved = vec![0.0; n * p];
        for (b, h) in h.iter().enumerate() {
            for (matrix, local) in j.iter_mut().zip(local) {
                self.jacobian(local, b, count, matrix);
            }
            transitions(&j, *h, &mut t, &mut temp, n);
            let [whole, half, one] = &t;
            let old = &mut out.transition[b * nn..(b + 1) * nn];
            multiply(whole, old, &mut temp, n);
            old.copy_from_slice(&temp);
            let u = &mut out.columns[b * n * p..(b + 1) * n * p];
            if out.steps > 1 {
                moved.copy_from_slice(u);
                u.fill(0.0);
                for i in 0..n {
                    for k in 0..n {
                        axpy(
                            whole[i * n + k],
                            &moved[k * p..(k + 1) * p],
                            &mut u[i * p..(i + 1) * p],
                        );
                    }
                }
            }
            for (node, (to_end, weight)) in
                [(whole, 1.0), (half, 4.0), (one, 1.0)].iter().enumerate()
            {
                let gain = self.gain(&local[node], b, count, to_end, weight * h / 6.0);
                let (values, ranges) = match self.all {
                    Some((_, ranges)) => (&all[node * p * count..(node + 1) * p * count], ranges),
                    None => (&local[node].columns[..], &self.code.ranges[..]),
                };
                add(&gain, values, ranges, (b, count, n, p), u);
            }
        }
    }

    /// ∂z'/∂z at one point.
    fn jacobian(&self, local: &Local, b: usize, count: usize, out: &mut [f64]) {
        let n = self.code.states;
        out.fill(0.0);
        for (i, next) in &self.code.chain {
            out[i * n + next] = 1.0;
        }
        for (l, i) in self.code.moved.iter().enumerate() {
            for j in 0..n {
                out[i * n + j] = local.jacobian[(l * n + j) * count + b];
            }
        }
    }

    /// What a unit of each law's right side at a point adds to the end state: n × laws.
    fn gain(&self, local: &Local, b: usize, count: usize, to_end: &[f64], weight: f64) -> Vec<f64> {
        let (n, m) = (self.code.states, self.code.laws);
        let mut out = vec![0.0; n * m];
        for i in 0..n {
            for (row, state) in self.code.moved.iter().enumerate() {
                let reach = weight * to_end[i * n + state];
                if local.solved.is_empty() {
                    out[i * m + row] += reach;
                    continue;
                }
                for l in 0..m {
                    out[i * m + l] += reach * local.solved[(row * m + l) * count + b];
                }
            }
        }
        out
    }
}

/// U += gain · φ, law by law.
fn add(
    gain: &[f64],
    values: &[f64],
    ranges: &[Range<usize>],
    (b, count, n, p): (usize, usize, usize, usize),
    u: &mut [f64],
) {
    let m = ranges.len();
    for (l, range) in ranges.iter().enumerate() {
        for j in range.clone() {
            let value = values[j * count + b];
            for i in 0..n {
                u[i * p + j] += gain[i * m + l] * value;
            }
        }
    }
}

/// Transitions to the end of a step: from its start, from its middle, from the end itself.
fn transitions(j: &[Vec<f64>; 3], h: f64, t: &mut [Vec<f64>; 3], temp: &mut [f64], n: usize) {
    let [whole, half, one] = t;
    unit(one, n);
    // Runge–Kutta on T' = J T, T(0) = 1: k₁ = J₀, k₂ = J½(1 + h/2 k₁), k₃ = J½(1 + h/2 k₂), k₄ = J₁(1 + h k₃).
    unit(whole, n);
    let mut k = j[0].clone();
    add_scaled(whole, h / 6.0, &k);
    for (matrix, reach, weight) in [(&j[1], 0.5, 2.0), (&j[1], 0.5, 2.0), (&j[2], 1.0, 1.0)] {
        k.iter_mut().for_each(|x| *x *= reach * h);
        (0..n).for_each(|i| k[i * n + i] += 1.0);
        multiply(matrix, &k, temp, n);
        k.copy_from_slice(temp);
        add_scaled(whole, weight * h / 6.0, &k);
    }
    // The second half, with the mean of its ends: exp(J h/2) to the third power.
    let mean: Vec<f64> = j[1]
        .iter()
        .zip(&j[2])
        .map(|(a, b)| 0.25 * h * (a + b))
        .collect();
    unit(half, n);
    let mut power = mean.clone();
    for divisor in [1.0, 2.0, 6.0] {
        add_scaled(half, 1.0 / divisor, &power);
        multiply(&mean, &power, temp, n);
        power.copy_from_slice(temp);
    }
}

fn unit(matrix: &mut [f64], n: usize) {
    matrix.fill(0.0);
    (0..n).for_each(|i| matrix[i * n + i] = 1.0);
}

fn identity(out: &mut Vec<f64>, n: usize, count: usize) {
    out.clear();
    out.resize(count * n * n, 0.0);
    out.chunks_exact_mut((n * n).max(1))
        .for_each(|t| unit(t, n));
}

fn add_scaled(to: &mut [f64], by: f64, what: &[f64]) {
    axpy(by, what, to);
}

fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}
