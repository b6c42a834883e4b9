//! One interval in which a law switches: from event to event, with the derivatives of the flow across them.
//!
//! In: laws by sides, a record, the state at a sample. Out: the state at the next sample, T and U as of other intervals. At an event the
//! transition jumps by the saltation matrix 1 + (f⁺ − f⁻) ∇g / ġ⁻ (Leine, Nijmeijer, "Dynamics and Bifurcations of Non-Smooth Mechanical
//! Systems", 2004, ch. 7); while a guard is held at zero, the flow and its derivatives are projected on it.

use std::ops::Range;

use super::compiled_laws::{Diverged, LocalLinearization, Scratch};
use super::dense_transition::transitions;
use super::switched_laws::SwitchedLaws;
use crate::trajectory::model::Record;
use nalgebra::{DMatrix, DVector};
use sidc_lang::term::Tape;
use sidc_system::switching::thresholds::SWITCHING;
use sidc_system::switching::{GuardRates, Located, Mode, Modes, SlidingRates, least_norm, locate};

/// What an interval is integrated with.
pub(super) struct SwitchedInterval<'a> {
    pub switched: &'a SwitchedLaws,
    pub coefficients: &'a [f64],
    /// All columns by sides; `None` where the active ones are wanted.
    pub all: Option<&'a Tape>,
    /// Columns of each law, among all or among the active ones.
    pub ranges: &'a [Range<usize>],
    pub record: &'a Record,
    pub interval: usize,
    /// Steps of an interval without events.
    pub steps: usize,
    pub spread: &'a [f64],
}

/// The end of an interval.
pub(super) struct IntervalEnd {
    pub state: DVector<f64>,
    pub transition: DMatrix<f64>,
    /// n × P.
    pub columns: DMatrix<f64>,
}

/// Buffers of an interval.
#[derive(Default)]
struct Buffers {
    point: Vec<f64>,
    scratch: Scratch,
    local: LocalLinearization,
    guards: Vec<f64>,
    tape: Vec<f64>,
    values: Vec<f64>,
    flow: Vec<f64>,
}

/// The laws linearised at a point, with sliding guards held.
struct Node {
    rates: DVector<f64>,
    jacobian: DMatrix<f64>,
    /// What a unit of each law's right side adds to the rates, n × laws.
    gain: DMatrix<f64>,
    values: Vec<f64>,
}

struct Run<'a> {
    own: SwitchedInterval<'a>,
    length: f64,
    modes: Modes,
    sides: Vec<f64>,
    buffers: Buffers,
}

impl SwitchedInterval<'_> {
    /// # Errors
    /// The laws have no finite rates somewhere.
    pub fn integrate(self, start: &[f64]) -> Result<IntervalEnd, Diverged> {
        let (n, k) = (start.len(), self.interval);
        let p = self.ranges.iter().map(|r| r.end).max().unwrap_or(0);
        let mut run = Run {
            length: self.record.time[k + 1] - self.record.time[k],
            modes: Modes(vec![Mode::Level; self.switched.count]),
            sides: vec![0.0; self.switched.count],
            buffers: Buffers::default(),
            own: self,
        };
        let mut reached = IntervalEnd {
            state: DVector::from_column_slice(start),
            transition: DMatrix::identity(n, n),
            columns: DMatrix::zeros(n, p),
        };
        run.begin(&mut reached)?;
        let (mut part, mut events) = (0.0, 0);
        while part < 1.0 {
            let left = (1.0 - part) * run.own.steps as f64;
            let reach = (1.0 - part) / left.ceil().max(1.0);
            let floor = run.margins(part, &reached.state)?;
            let end = run.step(part, &reached.state, reach)?;
            let margins = run.margins(part + reach, &end)?;
            let crossed: Vec<usize> = (0..margins.len())
                .filter(|k| margins[*k] < floor[*k].min(0.0))
                .collect();
            if crossed.is_empty() || events > SWITCHING.at_once {
                run.move_on(&mut reached, (part, reach), end)?;
                part = if left <= 1.0 { 1.0 } else { part + reach };
                continue;
            }
            events += 1;
            let over = |margins: &[f64]| {
                let above = margins.iter().zip(&floor).map(|(m, f)| m - f.min(0.0));
                above.fold(f64::INFINITY, f64::min)
            };
            let from = reached.state.clone();
            let mut margin = |share: f64| {
                let state = run.step(part, &from, share * reach)?;
                Ok(over(&run.margins(part + share * reach, &state)?))
            };
            match locate(over(&margins), &mut margin)? {
                Located::At(share) => {
                    let there = run.step(part, &from, share * reach)?;
                    run.move_on(&mut reached, (part, share * reach), there)?;
                    part += share * reach;
                    run.pass(&mut reached, part, &crossed)?;
                }
                Located::Start => {
                    let before = run.modes.clone();
                    run.pass(&mut reached, part, &crossed)?;
                    if run.modes == before {
                        run.cross(part + reach, &end, &crossed);
                    }
                }
            }
        }
        Ok(reached)
    }
}

impl Run<'_> {
    /// Sets the point of all evaluations: states, rates as they were, exogenous signals, sides.
    fn place(&mut self, part: f64, state: &DVector<f64>) {
        let laws = &self.own.switched.laws;
        let (n, m) = (laws.states, laws.laws);
        let point = &mut self.buffers.point;
        point.resize(laws.inputs, 0.0);
        point[..n].copy_from_slice(state.as_slice());
        let last = laws.inputs - self.own.switched.count;
        for (x, value) in point[n + m..last].iter_mut().enumerate() {
            *value = self.own.record.exogenous_at(x, self.own.interval, part);
        }
        let b = &mut self.buffers;
        (self.own.switched).guards(&b.point, 1, &mut b.guards, &mut b.tape);
        // Where columns switch that no law has, it is no event.
        for k in 0..self.own.switched.count {
            if !self.own.switched.active.contains(&k) {
                self.modes.0[k] = Mode::of(self.buffers.guards[k]);
            }
        }
    }

    /// ẋ at the present point with these sides.
    fn rates_by_sides(&mut self, sides: &[f64]) -> Result<DVector<f64>, Diverged> {
        let laws = &self.own.switched.laws;
        let b = &mut self.buffers;
        let from = laws.inputs - sides.len();
        b.point[from..].copy_from_slice(sides);
        laws.rates(self.own.coefficients, &mut b.point, 1, &mut b.scratch)?;
        b.flow.resize(laws.states, 0.0);
        laws.flow(&b.point, 1, &mut b.flow);
        Ok(DVector::from_column_slice(&b.flow))
    }

    /// ẋ at a point, sliding guards held.
    fn rates(&mut self, part: f64, state: &DVector<f64>) -> Result<DVector<f64>, Diverged> {
        self.place(part, state);
        let mut sides: Vec<f64> = self.modes.0.iter().map(|m| m.side()).collect();
        if self.modes.any_slides() {
            let contacts: Vec<usize> = self.modes.sliding().collect();
            let held = SlidingRates::measure(self, contacts, &mut sides)?;
            if !held.hold(&mut sides) {
                return Err(Diverged);
            }
        }
        self.sides.clone_from(&sides);
        self.rates_by_sides(&sides)
    }

    /// One step of the classical Runge–Kutta method over a part of the interval.
    fn step(
        &mut self,
        part: f64,
        state: &DVector<f64>,
        reach: f64,
    ) -> Result<DVector<f64>, Diverged> {
        let h = reach * self.length;
        let k1 = self.rates(part, state)?;
        let k2 = self.rates(part + 0.5 * reach, &(state + &k1 * (0.5 * h)))?;
        let k3 = self.rates(part + 0.5 * reach, &(state + &k2 * (0.5 * h)))?;
        let k4 = self.rates(part + reach, &(state + &k3 * h))?;
        let end = state + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0);
        match end.iter().all(|x| x.is_finite()) {
            true => Ok(end),
            false => Err(Diverged),
        }
    }

    /// What stays at or above zero until an event.
    fn margins(&mut self, part: f64, state: &DVector<f64>) -> Result<Vec<f64>, Diverged> {
        self.rates(part, state)?;
        let active = &self.own.switched.active;
        let margin = |k: usize| match active.contains(&k) {
            true => self.modes.0[k].margin(self.buffers.guards[k], self.sides[k]),
            false => 0.0,
        };
        Ok((0..self.own.switched.count).map(margin).collect())
    }

    /// ∂g/∂z of a guard at the present point.
    fn gradient(&self, guard: usize) -> DVector<f64> {
        let n = self.own.switched.laws.states;
        let mut out = DVector::zeros(n);
        for (e, (k, row)) in self.own.switched.gradient.iter().enumerate() {
            if *k == guard && *row < n {
                out[*row] = self.buffers.guards[self.own.switched.count + e];
            }
        }
        out
    }

    /// ġ of a guard for these rates.
    fn guard_rate(&self, guard: usize, rates: &DVector<f64>) -> f64 {
        let laws = &self.own.switched.laws;
        let (n, m) = (laws.states, laws.laws);
        let mut sum = 0.0;
        for (e, (k, row)) in self.own.switched.gradient.iter().enumerate() {
            if *k != guard {
                continue;
            }
            let slope = self.buffers.guards[self.own.switched.count + e];
            sum += slope
                * match *row {
                    i if i < n => rates[i],
                    i => (self.own.record).exogenous_slope(i - n - m, self.own.interval),
                };
        }
        sum
    }

    /// Sides at the start. A state that a contact holds has no effect on what comes.
    fn begin(&mut self, reached: &mut IntervalEnd) -> Result<(), Diverged> {
        self.place(0.0, &reached.state);
        let mut contacts = Vec::new();
        for k in self.own.switched.active.clone() {
            let guard = self.buffers.guards[k];
            let gradient = self.gradient(k);
            let terms = gradient.iter().zip(self.own.spread);
            let size: f64 = terms.map(|(d, s)| (d * s).abs()).sum();
            self.modes.0[k] = Mode::of(guard);
            if guard.abs() <= SWITCHING.zero * size {
                contacts.push(k);
            }
        }
        self.decide(contacts)?;
        if self.modes.any_slides() {
            reached.transition = self.projection(0.0, &reached.state)?;
        }
        Ok(())
    }

    fn decide(&mut self, contacts: Vec<usize>) -> Result<(), Diverged> {
        if contacts.is_empty() {
            return Ok(());
        }
        let mut sides: Vec<f64> = self.modes.0.iter().map(|m| m.side()).collect();
        let rates = SlidingRates::measure(self, contacts, &mut sides)?;
        let mut modes = std::mem::take(&mut self.modes);
        rates.decide(&mut modes, &mut sides);
        self.modes = modes;
        Ok(())
    }

    /// Passes an event: sides, and the saltation of the derivatives.
    fn pass(
        &mut self,
        reached: &mut IntervalEnd,
        part: f64,
        crossed: &[usize],
    ) -> Result<(), Diverged> {
        let before = self.rates(part, &reached.state)?;
        let guard = |k: &&usize| self.modes.0[**k] != Mode::Sliding;
        let nearest = |a: &&usize, b: &&usize| {
            self.buffers.guards[**a]
                .abs()
                .total_cmp(&self.buffers.guards[**b].abs())
        };
        let first = crossed.iter().filter(guard).min_by(nearest).copied();
        let salted = first.map(|k| (self.gradient(k), self.guard_rate(k, &before)));
        let mut contacts: Vec<usize> = self.modes.sliding().collect();
        match first {
            Some(k) => contacts.push(k),
            None => contacts.extend(
                crossed
                    .iter()
                    .filter(|k| !self.modes.sliding().any(|s| s == **k)),
            ),
        }
        contacts.sort_unstable();
        contacts.dedup();
        self.decide(contacts)?;
        let after = self.rates(part, &reached.state)?;
        if let Some((gradient, rate)) = salted.filter(|(_, rate)| *rate != 0.0) {
            let jump = (after - before) / rate;
            let saltation = DMatrix::identity(jump.len(), jump.len()) + jump * gradient.transpose();
            reached.transition = &saltation * &reached.transition;
            reached.columns = &saltation * &reached.columns;
        }
        Ok(())
    }

    /// The other sides of guards that are crossed where they begin.
    fn cross(&mut self, part: f64, end: &DVector<f64>, crossed: &[usize]) {
        self.place(part, end);
        for k in crossed {
            self.modes.0[*k] = match self.modes.0[*k] {
                Mode::Sliding => Mode::of(self.sides[*k]),
                _ => Mode::of(self.buffers.guards[*k]),
            };
        }
    }

    /// 1 − F (G F)⁻¹ G, which keeps sliding guards; F = ∂ẋ/∂σ, G = ∂g/∂z.
    fn projection(&mut self, part: f64, state: &DVector<f64>) -> Result<DMatrix<f64>, Diverged> {
        self.rates(part, state)?;
        let contacts: Vec<usize> = self.modes.sliding().collect();
        let (n, sides) = (state.len(), self.sides.clone());
        let mut by_side = DMatrix::zeros(n, contacts.len());
        let mut gradient = DMatrix::zeros(contacts.len(), n);
        for (c, k) in contacts.iter().enumerate() {
            gradient.set_row(c, &self.gradient(*k).transpose());
            let mut moved = sides.clone();
            moved[*k] = 1.0;
            let with = self.rates_by_sides(&moved)?;
            moved[*k] = 0.0;
            by_side.set_column(c, &(with - self.rates_by_sides(&moved)?));
        }
        self.rates_by_sides(&sides)?;
        let held = least_norm(&gradient * &by_side, &gradient);
        let held = held.ok_or(Diverged)?;
        Ok(DMatrix::identity(n, n) - by_side * held)
    }

    fn node(&mut self, part: f64, state: &DVector<f64>) -> Result<Node, Diverged> {
        let projection = match self.modes.any_slides() {
            true => Some(self.projection(part, state)?),
            false => None,
        };
        let rates = self.rates(part, state)?;
        let laws = &self.own.switched.laws;
        let (n, m) = (laws.states, laws.laws);
        let b = &mut self.buffers;
        laws.evaluate(
            self.own.coefficients,
            &mut b.point,
            1,
            &mut b.scratch,
            &mut b.local,
        )?;
        let mut jacobian = DMatrix::zeros(n, n);
        let mut gain = DMatrix::zeros(n, m);
        for (i, next) in &laws.chain {
            jacobian[(*i, *next)] = 1.0;
        }
        for (l, i) in laws.law_states.iter().enumerate() {
            for j in 0..n {
                jacobian[(*i, j)] = b.local.jacobian[l * n + j];
            }
            match b.local.solved.is_empty() {
                true => gain[(*i, l)] = 1.0,
                false => (0..m).for_each(|c| gain[(*i, c)] = b.local.solved[l * m + c]),
            }
        }
        let values = match self.own.all {
            None => b.local.columns.clone(),
            Some(tape) => {
                b.values.resize(tape.outputs(), 0.0);
                tape.eval(&b.point, 1, &mut b.values, &mut b.tape);
                b.values.clone()
            }
        };
        if let Some(projection) = projection {
            jacobian = &projection * jacobian;
            gain = &projection * gain;
        }
        Ok(Node {
            rates,
            jacobian,
            gain,
            values,
        })
    }

    /// Composes the derivatives of one step with those of the steps before it, and moves to its end.
    fn move_on(
        &mut self,
        reached: &mut IntervalEnd,
        (part, reach): (f64, f64),
        end: DVector<f64>,
    ) -> Result<(), Diverged> {
        let h = reach * self.length;
        let here = self.node(part, &reached.state)?;
        let next = self.node(part + reach, &end)?;
        let bend = (&here.rates - &next.rates) * (h / 8.0);
        let middle = self.node(part + 0.5 * reach, &((&reached.state + &end) * 0.5 + bend))?;
        let jacobians = [&here.jacobian, &middle.jacobian, &next.jacobian];
        let [whole, half, unit] = transitions(jacobians, h);
        reached.transition = &whole * &reached.transition;
        let mut columns = &whole * &reached.columns;
        let nodes = [
            (&here, &whole, 1.0),
            (&middle, &half, 4.0),
            (&next, &unit, 1.0),
        ];
        for (node, to_end, weight) in nodes {
            let gain = to_end * &node.gain * (weight * h / 6.0);
            for (l, range) in self.own.ranges.iter().enumerate() {
                for j in range.clone() {
                    let mut column = columns.column_mut(j);
                    column.axpy(node.values[j], &gain.column(l), 1.0);
                }
            }
        }
        reached.columns = columns;
        reached.state = end;
        Ok(())
    }
}

impl GuardRates for Run<'_> {
    type Error = Diverged;

    fn guard_rates(&mut self, sides: &[f64], out: &mut [f64]) -> Result<(), Diverged> {
        let rates = self.rates_by_sides(sides)?;
        for (k, out) in out.iter_mut().enumerate() {
            *out = self.guard_rate(k, &rates);
        }
        Ok(())
    }
}
