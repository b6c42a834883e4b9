//! Laws compiled to straight-line code: rates at many points at once, with their derivatives by state and by coefficient.
//!
//! In: a system, its active columns, points. Out: rates and derivatives. Every quantity is a row over all points (structure of arrays).
//! Laws whose terms contain rates are implicit; they are solved for the rates by Newton's method at each point.

use std::borrow::Cow;
use std::ops::Range;

use super::batched_inverse::invert;
use super::law_switches::LawSwitches;
use crate::trajectory::model::System;
use crate::trajectory::thresholds::SHOOTING;
use sidc_lang::term::{Expr, Signal, Tape};
use sidc_solve::simd::axpy;

/// The derivative of one row of values by one signal.
#[derive(Clone, Copy)]
struct PartialDerivative {
    /// Place of an active column; beyond these, of the known part of a law.
    row: usize,
    law: usize,
    /// A state (below n) or a rate.
    input: usize,
}

/// The laws with some of their columns active.
pub(crate) struct CompiledLaws {
    pub states: usize,
    pub laws: usize,
    /// Rows of inputs: states, targets, exogenous signals, sides of the switches.
    pub inputs: usize,
    /// Where active laws jump; `None` if they do not.
    pub switches: Option<LawSwitches>,
    /// The active columns, rising.
    pub active: Vec<usize>,
    /// For each law its columns, as places in `active`.
    pub ranges: Vec<Range<usize>>,
    /// The state that each law moves.
    pub law_states: Vec<usize>,
    /// (state, the state that is its rate)
    pub chain: Vec<(usize, usize)>,
    /// Whether nothing measures some of the states.
    pub has_hidden: bool,
    /// States that no law moves.
    held: Vec<usize>,
    values: Tape,
    slopes: Tape,
    entries: Vec<PartialDerivative>,
    implicit: Option<ImplicitRates>,
}

/// Compiled derivatives by rates, for laws that contain rates.
struct ImplicitRates {
    /// Values, then their derivatives by rates.
    tape: Tape,
    slopes: Vec<PartialDerivative>,
    /// Whether these derivatives contain no rate, so that one Newton step is exact.
    linear: bool,
}

/// The laws linearised at points.
#[derive(Default)]
pub(crate) struct LocalLinearization {
    /// Values of active columns, k × points.
    pub columns: Vec<f64>,
    /// ∂w/∂z, laws × states × points.
    pub jacobian: Vec<f64>,
    /// (1 − ∂g/∂w)⁻¹, laws × laws × points; empty if no law contains a rate.
    pub solved: Vec<f64>,
}

/// Buffers that evaluations share.
#[derive(Default)]
pub(crate) struct Scratch {
    out: Vec<f64>,
    tape: Vec<f64>,
    small: Vec<f64>,
    matrix: Vec<f64>,
    inverse: Vec<f64>,
    gap: Vec<f64>,
}

/// The laws have no finite rates somewhere, or the work was cancelled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Diverged;

impl CompiledLaws {
    pub fn new(system: &System, active: &[usize]) -> CompiledLaws {
        let mut inputs = system.evaluation_signals();
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
        let mut switches = None;
        if let Some((smooth, found)) = LawSwitches::of(&values, system, &inputs) {
            values = smooth;
            inputs.extend(found.signals());
            switches = Some(found);
        }
        let mut entries = Vec::new();
        let mut slopes = values.clone();
        for (row, (value, law)) in values.iter().zip(&laws).enumerate() {
            for (input, signal) in inputs.iter().take(n + m).enumerate() {
                if value.mentions(*signal) {
                    slopes.push(value.derivative(*signal));
                    entries.push(PartialDerivative {
                        row,
                        law: *law,
                        input,
                    });
                }
            }
        }
        let by_rates: Vec<PartialDerivative> =
            entries.iter().copied().filter(|e| e.input >= n).collect();
        let implicit = (!by_rates.is_empty()).then(|| {
            let wanted = entries.iter().zip(&slopes[values.len()..]);
            let wanted = wanted.filter(|(e, _)| e.input >= n);
            let wanted: Vec<Expr> = wanted.map(|(_, s)| s.clone()).collect();
            let rates = &inputs[n..n + m];
            let linear = !wanted.iter().any(|s| rates.iter().any(|w| s.mentions(*w)));
            let all = [&values[..], &wanted[..]].concat();
            ImplicitRates {
                tape: tape(&all, &inputs),
                slopes: by_rates,
                linear,
            }
        });
        let of = |l: usize| {
            let from = laws[..active.len()].iter().filter(|x| **x < l).count();
            let count = laws[..active.len()].iter().filter(|x| **x == l).count();
            from..from + count
        };
        let law_states: Vec<usize> = system.laws.iter().map(|l| l.state).collect();
        let chain: Vec<(usize, usize)> = (0..n)
            .filter_map(|i| Some((i, system.derivative_state(i)?)))
            .collect();
        let moved = |i: &usize| law_states.contains(i) || chain.iter().any(|(from, _)| from == i);
        CompiledLaws {
            states: n,
            laws: m,
            inputs: inputs.len(),
            switches,
            active: active.to_vec(),
            ranges: (0..m).map(of).collect(),
            has_hidden: !system.hidden.is_empty(),
            held: (0..n).filter(|i| !moved(i)).collect(),
            law_states,
            chain,
            values: tape(&values, &inputs),
            slopes: tape(&slopes, &inputs),
            entries,
            implicit,
        }
    }

    /// Whether a law contains rates.
    pub fn is_implicit(&self) -> bool {
        self.implicit.is_some()
    }

    /// All candidate columns for these laws: as compiled for laws without switches, or with σ of theirs as further signals.
    pub fn columns<'a>(&self, system: &System, all: &'a Tape) -> Cow<'a, Tape> {
        let Some(switches) = &self.switches else {
            return Cow::Borrowed(all);
        };
        let mut inputs = system.evaluation_signals();
        let rates = inputs[self.states..self.states + self.laws].to_vec();
        let columns = system.columns.iter();
        let columns = columns.map(|t| switches.rewritten(t, &rates));
        let columns: Vec<Expr> = columns.collect();
        inputs.extend(switches.signals());
        Cow::Owned(tape(&columns, &inputs))
    }

    /// Writes the rates into their rows of `points`, which has `inputs` rows of `count` points.
    ///
    /// # Errors
    /// A rate that is not finite, or implicit laws that cannot be solved.
    pub fn rates(
        &self,
        a: &[f64],
        points: &mut [f64],
        count: usize,
        scratch: &mut Scratch,
    ) -> Result<(), Diverged> {
        let (n, m) = (self.states, self.laws);
        let Some(implicit) = &self.implicit else {
            let out = resized(&mut scratch.out, self.values.outputs() * count);
            self.values.eval(points, count, out, &mut scratch.tape);
            self.sum_terms(a, out, &mut points[n * count..(n + m) * count], count);
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
        let out = resized(out, implicit.tape.outputs() * count);
        let matrix = resized(matrix, m * m * count);
        let inverse = resized(inverse, m * m * count);
        let gap = resized(gap, m * count);
        let mut step = f64::INFINITY;
        for _ in 0..SHOOTING.newton_steps {
            implicit.tape.eval(points, count, out, tape);
            self.sum_terms(a, out, gap, count);
            let gradients = &out[(self.active.len() + m) * count..];
            self.implicit_matrix(a, &implicit.slopes, gradients, count, matrix);
            if !invert(matrix, inverse, m, count, small) {
                return Err(Diverged);
            }
            let rates = &mut points[n * count..(n + m) * count];
            gap.iter_mut().zip(&*rates).for_each(|(g, w)| *g -= w);
            step = newton(rates, inverse, gap, m, count);
            finite(rates)?;
            if implicit.linear || step < SHOOTING.newton_converged {
                return Ok(());
            }
        }
        if step < SHOOTING.newton_accepted {
            Ok(())
        } else {
            Err(Diverged)
        }
    }

    /// Rates as [`CompiledLaws::rates`] gives them, and the laws linearised there.
    ///
    /// # Errors
    /// The same, or a derivative that is not finite.
    pub fn evaluate(
        &self,
        a: &[f64],
        points: &mut [f64],
        count: usize,
        scratch: &mut Scratch,
        local: &mut LocalLinearization,
    ) -> Result<(), Diverged> {
        let (n, m) = (self.states, self.laws);
        if self.implicit.is_some() {
            self.rates(a, points, count, scratch)?;
        }
        let out = resized(&mut scratch.out, self.slopes.outputs() * count);
        self.slopes.eval(points, count, out, &mut scratch.tape);
        if self.implicit.is_none() {
            let rates = &mut points[n * count..(n + m) * count];
            self.sum_terms(a, out, rates, count);
            finite(rates)?;
        }
        self.linearise(a, count, scratch, local)
    }

    /// From the values and derivatives that are in `scratch`.
    fn linearise(
        &self,
        a: &[f64],
        count: usize,
        scratch: &mut Scratch,
        local: &mut LocalLinearization,
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
        if self.implicit.is_some() {
            local.solved.resize(m * m * count, 0.0);
            let matrix = resized(&mut scratch.matrix, m * m * count);
            self.implicit_matrix(a, &self.entries, gradients, count, matrix);
            if !invert(matrix, &mut local.solved, m, count, &mut scratch.small) {
                return Err(Diverged);
            }
            self.solve_jacobian(local, count, &mut scratch.gap);
        }
        finite(&local.jacobian)
    }

    /// ∂w/∂z = (1 − ∂g/∂w)⁻¹ ∂g/∂z.
    fn solve_jacobian(&self, local: &mut LocalLinearization, count: usize, moved: &mut Vec<f64>) {
        let (n, m) = (self.states, self.laws);
        let moved = resized(moved, m * n * count);
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
    fn implicit_matrix(
        &self,
        a: &[f64],
        slopes: &[PartialDerivative],
        gradients: &[f64],
        count: usize,
        out: &mut [f64],
    ) {
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
    fn sum_terms(&self, a: &[f64], values: &[f64], rates: &mut [f64], count: usize) {
        let k = self.active.len();
        rates.copy_from_slice(&values[k * count..(k + self.laws) * count]);
        for (l, range) in self.ranges.iter().enumerate() {
            for j in range.clone() {
                let row = &values[j * count..(j + 1) * count];
                axpy(a[j], row, &mut rates[l * count..(l + 1) * count]);
            }
        }
    }

    /// dz/dt at points: the next derivative of the same variable, or what the law gives.
    pub fn flow(&self, points: &[f64], count: usize, out: &mut [f64]) {
        for (i, next) in &self.chain {
            out[i * count..(i + 1) * count]
                .copy_from_slice(&points[next * count..(next + 1) * count]);
        }
        for (l, i) in self.law_states.iter().enumerate() {
            let from = (self.states + l) * count;
            out[i * count..(i + 1) * count].copy_from_slice(&points[from..from + count]);
        }
        for i in &self.held {
            out[i * count..(i + 1) * count].fill(0.0);
        }
    }
}

/// Adds inverse · gap to the rates; returns the largest relative step.
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

/// Every signal of the expressions is among the inputs by construction, so the default is never taken.
fn tape(outputs: &[Expr], inputs: &[Signal]) -> Tape {
    Tape::new(outputs, inputs).unwrap_or_default()
}

fn resized(buffer: &mut Vec<f64>, size: usize) -> &mut [f64] {
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
