//! Laws by the sides of their switches, compiled, and the guards that say which side.
//!
//! In: a system, its active columns. Out: smooth laws with a row for the side of each switch after the exogenous signals, guards and their
//! gradients. What a side means is decided in `sidc_system::switching`.

use std::ops::Range;

use super::compiled_laws::{CompiledLaws, tape};
use crate::trajectory::model::{Record, System};
use sidc_lang::term::{Expr, Tape};
use sidc_system::switching::Switches;

/// Laws by the sides of their switches.
pub(crate) struct SwitchedLaws {
    pub laws: CompiledLaws,
    /// Switches of all columns.
    pub count: usize,
    /// Those of the active columns and the known parts: where these switch is an event.
    pub active: Vec<usize>,
    /// Guards, then their derivatives.
    guards: Tape,
    /// Guard and row of inputs of each derivative.
    pub gradient: Vec<(usize, usize)>,
}

impl SwitchedLaws {
    /// `values`: of the active columns, then of the known parts. `None` where none of them switches.
    pub fn new(system: &System, active: &[usize], values: &[Expr]) -> Option<SwitchedLaws> {
        let is_switched = |e: &Expr| e.terms().any(|(_, t)| Switches::are_in(t));
        if !values.iter().any(is_switched) {
            return None;
        }
        let (mut switches, rates) = (system.switches(), system.rates());
        let smooth: Vec<Expr> = (values.iter())
            .map(|e| switches.rewritten(e, &rates))
            .collect();
        let own = |k: &usize| {
            let side = Switches::signal(*k);
            smooth.iter().any(|e| e.mentions(side))
        };
        let own: Vec<usize> = (0..switches.len()).filter(own).collect();
        if own.is_empty() {
            return None;
        }
        let inputs = system.signals_with_sides(&switches);
        let mut outputs = switches.guards.clone();
        let mut gradient = Vec::new();
        for (k, guard) in switches.guards.iter().enumerate() {
            for (row, signal) in inputs.iter().enumerate() {
                if guard.mentions(*signal) {
                    outputs.push(guard.derivative(*signal));
                    gradient.push((k, row));
                }
            }
        }
        Some(SwitchedLaws {
            laws: CompiledLaws::of_values(system, active, &smooth, &inputs),
            count: switches.len(),
            active: own,
            guards: tape(&outputs, &inputs),
            gradient,
        })
    }

    /// Guards, then their derivatives, at points; rows of `count` points each.
    pub fn guards(&self, points: &[f64], count: usize, out: &mut Vec<f64>, work: &mut Vec<f64>) {
        out.resize(self.guards.outputs() * count, 0.0);
        self.guards.eval(points, count, out, work);
    }

    /// Places in a block of the intervals in which a guard of a law changes its sign, or begins at zero. `ends`: where the laws lead
    /// without events, n each.
    pub fn switching_intervals(
        &self,
        (record, states): (&Record, &[f64]),
        intervals: &Range<usize>,
        ends: &[f64],
    ) -> Vec<usize> {
        let (n, count) = (self.laws.states, intervals.len());
        let signals = self.laws.inputs;
        let first = n + self.laws.laws;
        let mut points = vec![0.0; signals * 2 * count];
        for (b, k) in intervals.clone().enumerate() {
            let both = [(b, &states[k * n..]), (count + b, &ends[b * n..])];
            for (part, (at, state)) in both.into_iter().enumerate() {
                (0..n).for_each(|i| points[i * 2 * count + at] = state[i]);
                for x in 0..signals - first - self.count {
                    points[(first + x) * 2 * count + at] = record.exogenous_at(x, k, part as f64);
                }
            }
        }
        let (mut guards, mut work) = (Vec::new(), Vec::new());
        self.guards(&points, 2 * count, &mut guards, &mut work);
        let crosses = |b: &usize| {
            self.active.iter().any(|g| {
                let row = &guards[g * 2 * count..(g + 1) * 2 * count];
                // Not a number is left to the steps that made it.
                row[*b] * row[count + *b] <= 0.0
            })
        };
        (0..count).filter(crosses).collect()
    }
}
