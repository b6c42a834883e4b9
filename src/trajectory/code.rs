//! Terms → straight-line code for their values and slopes at many points, and the rates of a system from it.
//!
//! In: a system, the columns that are active. Out: rates, their derivatives by state and by coefficient. Points lie beside each
//! other: every quantity is a row of all points (structure of arrays). Laws whose terms mention rates are solved by Newton's
//! method, point by point.

use std::ops::Range;

use super::dense;
use super::system::System;
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
    /// Values with their slopes by targets, where there are any.
    turns: Option<(Tape, Vec<Slope>)>,
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
            let mut all = values.clone();
            let wanted = entries.iter().zip(&slopes[values.len()..]);
            let wanted = wanted.filter(|(e, _)| e.input >= n);
            all.extend(wanted.map(|(_, s)| s.clone()));
            (tape(&all, &inputs), turning)
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
        let Some((turns, slopes)) = &self.turns else {
            let out = grown(&mut scratch.out, self.values.outputs() * count);
            self.values.eval(points, count, out, &mut scratch.tape);
            self.add_up(a, out, &mut points[n * count..(n + m) * count], count);
            return finite(&points[n * count..(n + m) * count]);
        };
        let mut gap = f64::INFINITY;
        let mut known = vec![0.0; m * count];
        for _ in 0..NEWTON {
            let out = grown(&mut scratch.out, turns.outputs() * count);
            turns.eval(points, count, out, &mut scratch.tape);
            self.add_up(a, out, &mut known, count);
            let gradients = &out[(self.active.len() + m) * count..];
            gap = 0.0;
            for b in 0..count {
                let mut matrix = vec![0.0; m * m];
                self.turn(a, slopes, gradients, count, b, &mut matrix);
                let mut step: Vec<f64> = (0..m)
                    .map(|l| known[l * count + b] - points[(n + l) * count + b])
                    .collect();
                if !dense::solve(&mut matrix, &mut step, m, 1) {
                    return Err(Diverged);
                }
                for (l, s) in step.iter().enumerate() {
                    let w = &mut points[(n + l) * count + b];
                    *w += s;
                    gap = f64::max(gap, s.abs() / (1.0 + w.abs()));
                }
            }
            if gap.is_nan() {
                return Err(Diverged);
            }
            if gap < ARRIVED {
                break;
            }
        }
        if gap < CLOSE { Ok(()) } else { Err(Diverged) }
    }

    /// Everything at points whose rates are known.
    pub fn linearise(
        &self,
        a: &[f64],
        points: &[f64],
        count: usize,
        scratch: &mut Scratch,
        local: &mut Local,
    ) -> Result<(), Diverged> {
        let (n, m, k) = (self.states, self.laws, self.active.len());
        let Scratch { out, tape, small } = scratch;
        let out = grown(out, self.slopes.outputs() * count);
        self.slopes.eval(points, count, out, tape);
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
            self.solve_for_rates(a, gradients, count, small, local)?;
        }
        finite(&local.jacobian)
    }

    fn solve_for_rates(
        &self,
        a: &[f64],
        gradients: &[f64],
        count: usize,
        small: &mut Vec<f64>,
        local: &mut Local,
    ) -> Result<(), Diverged> {
        let (n, m) = (self.states, self.laws);
        local.solved.resize(m * m * count, 0.0);
        for b in 0..count {
            let mut matrix = vec![0.0; m * m];
            self.turn(a, &self.entries, gradients, count, b, &mut matrix);
            // Right sides: unit vectors, then the jacobian by states.
            small.clear();
            for l in 0..m {
                small.extend((0..m).map(|c| if c == l { 1.0 } else { 0.0 }));
                small.extend((0..n).map(|i| local.jacobian[(l * n + i) * count + b]));
            }
            if !dense::solve(&mut matrix, small, m, m + n) {
                return Err(Diverged);
            }
            for l in 0..m {
                let row = &small[l * (m + n)..(l + 1) * (m + n)];
                for (c, x) in row[..m].iter().enumerate() {
                    local.solved[(l * m + c) * count + b] = *x;
                }
                for (i, x) in row[m..].iter().enumerate() {
                    local.jacobian[(l * n + i) * count + b] = *x;
                }
            }
        }
        Ok(())
    }

    /// 1 − ∂g/∂w at one point.
    fn turn(
        &self,
        a: &[f64],
        slopes: &[Slope],
        gradients: &[f64],
        count: usize,
        b: usize,
        matrix: &mut [f64],
    ) {
        let (n, m) = (self.states, self.laws);
        for l in 0..m {
            matrix[l * m + l] = 1.0;
        }
        for (e, row) in slopes.iter().zip(gradients.chunks_exact(count)) {
            if e.input >= n {
                let weight = a.get(e.row).copied().unwrap_or(1.0);
                matrix[e.law * m + e.input - n] -= weight * row[b];
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

fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}
