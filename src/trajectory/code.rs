//! Terms → straight-line code for their values and slopes at many points, and the rates of a system from it.
//!
//! In: a system, the columns that are active. Out: rates, their derivatives by state and by coefficient. Points lie beside each
//! other: every quantity is a row of all points (structure of arrays). Laws whose terms mention rates are solved by Newton's
//! method, point by point.

use std::ops::Range;

use super::dense;
use super::system::System;
use crate::lanes::axpy;
use crate::term::{Expr, Signal, Tape};

/// Newton steps for laws that contain rates; those linear in the rates need one.
const NEWTON: usize = 8;
/// Change of a rate, relative, at which Newton's method has arrived.
const ARRIVED: f64 = 1e-12;
/// Change at which it is taken to have arrived, if it comes no closer.
const CLOSE: f64 = 1e-6;

/// A derivative of one row of values.
#[derive(Clone, Copy)]
struct Slope {
    /// Row: an active column, or after those, a law's known part.
    row: usize,
    law: usize,
    /// State (below n) or target.
    input: usize,
}

/// Compiled laws with some active columns.
pub(super) struct Code {
    pub states: usize,
    pub laws: usize,
    /// Rows of inputs: states, targets, outside.
    pub inputs: usize,
    /// The active columns, rising.
    pub active: Vec<usize>,
    /// Which of them belong to each law.
    pub ranges: Vec<Range<usize>>,
    /// The state that each law moves.
    pub moved: Vec<usize>,
    /// (state, the state that is its rate)
    pub chain: Vec<(usize, usize)>,
    values: Tape,
    slopes: Tape,
    entries: Vec<Slope>,
    turns: Option<Turns>,
}

/// Laws that mention rates.
struct Turns {
    /// Values, and their slopes by rates.
    tape: Tape,
    slopes: Vec<Slope>,
    /// No slope mentions a rate itself.
    linear: bool,
}

/// Rates at points and how they answer.
#[derive(Default)]
pub(super) struct Local {
    /// Values of active columns, k × points.
    pub columns: Vec<f64>,
    /// ∂w/∂z, laws × states × points.
    pub jacobian: Vec<f64>,
    /// (1 − ∂g/∂w)⁻¹, laws × laws × points; empty if no law mentions a rate.
    pub solved: Vec<f64>,
}

/// Scratch of evaluations.
#[derive(Default)]
pub(super) struct Scratch {
    out: Vec<f64>,
    tape: Vec<f64>,
    small: Vec<f64>,
    matrix: Vec<f64>,
    inverse: Vec<f64>,
    gap: Vec<f64>,
}

/// A rate that is not finite, or laws that cannot be solved for the rates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Diverged;

impl Code {
    pub fn new(system: &System, active: &[usize]) -> Code {
        let inputs = system.inputs();
        let (n, m) = (system.states.len(), system.laws.len());
        let mut values: Vec<Expr> = Vec::new();
        let mut laws = Vec::new();
        for j in active {
            if let Some(term) = system.columns.get(*j) {
                values.push(term.clone().into());
                laws.push(system.law_of(*j));
            }
        }
        for (l, law) in system.laws.iter().enumerate() {
            values.push(law.known.clone());
            laws.push(l);
        }
        let mut entries = Vec::new();
        let mut slopes = values.clone();
        for (row, (value, law)) in values.iter().zip(&laws).enumerate() {
            for (input, signal) in inputs.iter().take(n + m).enumerate() {
                if value.mentions(*signal) {
                    slopes.push(value.derivative(*signal));
                    entries.push(Slope {
                        row,
                        law: *law,
                        input,
                    });
                }
            }
        }
        let turning: Vec<Slope> = entries.iter().copied().filter(|e| e.input >= n).collect();
        let turns = (!turning.is_empty()).then(|| {
            let wanted = entries.iter().zip(&slopes[values.len()..]);
            let wanted = wanted.filter(|(e, _)| e.input >= n);
            let wanted: Vec<Expr> = wanted.map(|(_, s)| s.clone()).collect();
            let rates = &inputs[n..n + m];
            let linear = !wanted.iter().any(|s| rates.iter().any(|w| s.mentions(*w)));
            let all = [&values[..], &wanted[..]].concat();
            Turns {
                tape: tape(&all, &inputs),
                slopes: turning,
                linear,
            }
        });
        let of = |l: usize| {
            let from = laws[..active.len()].iter().filter(|x| **x < l).count();
            let count = laws[..active.len()].iter().filter(|x| **x == l).count();
            from..from + count
        };
        Code {
            states: n,
            laws: m,
            inputs: inputs.len(),
            active: active.to_vec(),
            ranges: (0..m).map(of).collect(),
            moved: system.laws.iter().map(|l| l.state).collect(),
            chain: (0..n)
                .filter_map(|i| Some((i, system.follows(i)?)))
                .collect(),
            values: tape(&values, &inputs),
            slopes: tape(&slopes, &inputs),
            entries,
            turns,
        }
    }

    /// Puts the rates into the rows of the targets. `points` has `inputs` rows.
    pub fn rates(
        &self,
        a: &[f64],
        points: &mut [f64],
        count: usize,
        scratch: &mut Scratch,
    ) -> Result<(), Diverged> {
        let (n, m) = (self.states, self.laws);
        let Some(turns) = &self.turns else {
            let out = grown(&mut scratch.out, self.values.outputs() * count);
            self.values.eval(points, count, out, &mut scratch.tape);
            self.add_up(a, out, &mut points[n * count..(n + m) * count], count);
            return finite(&points[n * count..(n + m) * count]);
        };
        let Scratch {
            out,
            tape,
            small,
            matrix,
            inverse,
            gap,
        } = scratch;
        let out = grown(out, turns.tape.outputs() * count);
        let matrix = grown(matrix, m * m * count);
        let inverse = grown(inverse, m * m * count);
        let gap = grown(gap, m * count);
        let mut step = f64::INFINITY;
        for _ in 0..NEWTON {
            turns.tape.eval(points, count, out, tape);
            self.add_up(a, out, gap, count);
            let gradients = &out[(self.active.len() + m) * count..];
            self.turn(a, &turns.slopes, gradients, count, matrix);
            if !dense::invert(matrix, inverse, m, count, small) {
                return Err(Diverged);
            }
            let rates = &mut points[n * count..(n + m) * count];
            gap.iter_mut().zip(&*rates).for_each(|(g, w)| *g -= w);
            step = newton(rates, inverse, gap, m, count);
            finite(rates)?;
            // Laws linear in the rates are solved by one step.
            if turns.linear || step < ARRIVED {
                return Ok(());
            }
        }
        if step < CLOSE { Ok(()) } else { Err(Diverged) }
    }

    /// Rates, and everything that follows from them.
    pub fn evaluate(
        &self,
        a: &[f64],
        points: &mut [f64],
        count: usize,
        scratch: &mut Scratch,
        local: &mut Local,
    ) -> Result<(), Diverged> {
        let (n, m) = (self.states, self.laws);
        if self.turns.is_some() {
            self.rates(a, points, count, scratch)?;
        }
        let out = grown(&mut scratch.out, self.slopes.outputs() * count);
        self.slopes.eval(points, count, out, &mut scratch.tape);
        if self.turns.is_none() {
            let rates = &mut points[n * count..(n + m) * count];
            self.add_up(a, out, rates, count);
            finite(rates)?;
        }
        self.linearise(a, count, scratch, local)
    }

    /// From the values and slopes of all rows.
    fn linearise(
        &self,
        a: &[f64],
        count: usize,
        scratch: &mut Scratch,
        local: &mut Local,
    ) -> Result<(), Diverged> {
        let (n, m, k) = (self.states, self.laws, self.active.len());
        let out = &scratch.out[..self.slopes.outputs() * count];
        local.columns.clear();
        local.columns.extend_from_slice(&out[..k * count]);
        local.jacobian.clear();
        local.jacobian.resize(m * n * count, 0.0);
        let gradients = &out[(k + m) * count..];
        for (e, row) in self.entries.iter().zip(gradients.chunks_exact(count)) {
            if e.input < n {
                let weight = a.get(e.row).copied().unwrap_or(1.0);
                let at = (e.law * n + e.input) * count;
                axpy(weight, row, &mut local.jacobian[at..at + count]);
            }
        }
        local.solved.clear();
        if self.turns.is_some() {
            local.solved.resize(m * m * count, 0.0);
            let matrix = grown(&mut scratch.matrix, m * m * count);
            self.turn(a, &self.entries, gradients, count, matrix);
            if !dense::invert(matrix, &mut local.solved, m, count, &mut scratch.small) {
                return Err(Diverged);
            }
            self.answer(local, count, &mut scratch.gap);
        }
        finite(&local.jacobian)
    }

    /// The jacobian of the laws as they stand → that of the rates solved for.
    fn answer(&self, local: &mut Local, count: usize, moved: &mut Vec<f64>) {
        let (n, m) = (self.states, self.laws);
        let moved = grown(moved, m * n * count);
        moved.fill(0.0);
        for l in 0..m {
            for c in 0..m {
                let weights = &local.solved[(l * m + c) * count..(l * m + c + 1) * count];
                for i in 0..n {
                    let from = &local.jacobian[(c * n + i) * count..(c * n + i + 1) * count];
                    let to = &mut moved[(l * n + i) * count..(l * n + i + 1) * count];
                    for ((to, from), weight) in to.iter_mut().zip(from).zip(weights) {
                        *to += weight * from;
                    }
                }
            }
        }
        local.jacobian.copy_from_slice(moved);
    }

    /// 1 − ∂g/∂w, laws × laws × points.
    fn turn(&self, a: &[f64], slopes: &[Slope], gradients: &[f64], count: usize, out: &mut [f64]) {
        let (n, m) = (self.states, self.laws);
        out.fill(0.0);
        for diagonal in out.chunks_exact_mut(count).step_by(m + 1) {
            diagonal.fill(1.0);
        }
        for (e, row) in slopes.iter().zip(gradients.chunks_exact(count)) {
            if e.input >= n {
                let weight = a.get(e.row).copied().unwrap_or(1.0);
                let at = (e.law * m + e.input - n) * count;
                axpy(-weight, row, &mut out[at..at + count]);
            }
        }
    }

    /// g = known + Σ a·φ for every law.
    fn add_up(&self, a: &[f64], values: &[f64], rates: &mut [f64], count: usize) {
        let k = self.active.len();
        rates.copy_from_slice(&values[k * count..(k + self.laws) * count]);
        for (l, range) in self.ranges.iter().enumerate() {
            for j in range.clone() {
                let row = &values[j * count..(j + 1) * count];
                axpy(a[j], row, &mut rates[l * count..(l + 1) * count]);
            }
        }
    }

    /// The whole rate of every state at a point: what follows in the chain, or what its law gives.
    pub fn flow(&self, points: &[f64], count: usize, out: &mut [f64]) {
        for (i, next) in &self.chain {
            out[i * count..(i + 1) * count]
                .copy_from_slice(&points[next * count..(next + 1) * count]);
        }
        for (l, i) in self.moved.iter().enumerate() {
            let from = (self.states + l) * count;
            out[i * count..(i + 1) * count].copy_from_slice(&points[from..from + count]);
        }
    }
}

/// Moves the rates by inverse · gap; the largest step, relative.
fn newton(rates: &mut [f64], inverse: &[f64], gap: &[f64], m: usize, count: usize) -> f64 {
    let mut largest = 0.0;
    for (l, rates) in rates.chunks_exact_mut(count).enumerate() {
        for (b, w) in rates.iter_mut().enumerate() {
            let step: f64 = (0..m)
                .map(|c| inverse[(l * m + c) * count + b] * gap[c * count + b])
                .sum();
            *w += step;
            largest = f64::max(largest, step.abs() / (1.0 + w.abs()));
        }
    }
    largest
}

/// Tape over signals that are all there by construction.
fn tape(outputs: &[Expr], inputs: &[Signal]) -> Tape {
    Tape::new(outputs, inputs).unwrap_or_default()
}

fn grown(buffer: &mut Vec<f64>, size: usize) -> &mut [f64] {
    if buffer.len() < size {
        buffer.resize(size, 0.0);
    }
    &mut buffer[..size]
}

fn finite(values: &[f64]) -> Result<(), Diverged> {
    if values.iter().all(|x| x.is_finite()) {
        Ok(())
    } else {
        Err(Diverged)
    }
}
