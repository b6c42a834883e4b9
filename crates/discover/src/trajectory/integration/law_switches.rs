//! The switches of laws that jump or bend: their guards, on which side each is, and how fast the guards move.
//!
//! In: laws as written. Out: laws that are smooth while every switch keeps its side, guards and their gradients at points. A step across a
//! bend errs by its square, which is more than exact readings and noise of 0.1 % allow.

use super::state_jumps::StateJump;
use crate::trajectory::model::{ImpulseSource, System};
use crate::trajectory::thresholds::SHOOTING;
use sidc_lang::term::{Expr, Signal, Tape, Term};
use sidc_system::switching::{Mode, Modes, Switches};

/// Guards of the active laws, compiled.
pub(crate) struct LawSwitches {
    switches: Switches,
    /// The first row of σ among the rows of points.
    pub first: usize,
    /// Guards.
    guards: Tape,
    /// Their derivatives by every state, then by every exogenous signal, guard after guard.
    slopes: Tape,
    /// The row of each guard's impulse among those of points, where a column has it.
    impulses: Vec<Option<usize>>,
    /// Of each constant that acts where states jump: the row of its impulse among those of points, and its place among exogenous signals.
    pub jump_constants: Vec<(usize, usize)>,
    /// Where states jump.
    pub resets: Vec<StateJump>,
    /// Whether a guard depends on the states, and not on exogenous signals alone.
    follows_states: Vec<bool>,
    states: usize,
    exogenous: usize,
}

/// Guards and their derivatives at one point.
#[derive(Clone, Debug, Default)]
pub(super) struct Gradients {
    /// Guards × states.
    pub by_state: Vec<f64>,
    /// Guards × exogenous signals.
    pub by_exogenous: Vec<f64>,
}

impl LawSwitches {
    /// The laws with their switches as further signals, if they have any. `signals`: states, rates, exogenous signals.
    pub fn of(
        values: &[Expr],
        system: &System,
        signals: &[Signal],
    ) -> Option<(Vec<Expr>, LawSwitches)> {
        let (states, laws) = (system.states.len(), system.laws.len());
        // Most laws have none, and laws are compiled for every fit.
        let switch = |e: &Expr| e.terms().any(|(_, t)| Switches::are_in(t));
        if system.resets.is_empty() && !values.iter().any(switch) {
            return None;
        }
        let mut switches = Switches::default();
        let rates = &signals[states..states + laws];
        let smooth = values.iter().map(|e| switches.rewritten(e, rates));
        let smooth: Vec<Expr> = smooth.collect();
        switches.add_resets(&system.resets);
        if switches.is_empty() {
            return None;
        }
        let exogenous = &signals[states + laws..];
        let sources = signals[..states].iter().chain(exogenous);
        let slopes: Vec<Expr> = (switches.guards.iter())
            .flat_map(|g| sources.clone().map(|s| g.derivative(*s)))
            .collect();
        let inputs: Vec<Signal> = [signals, &switches.signals()].concat();
        let follows = |g: &Expr| signals[..states].iter().any(|s| g.mentions(*s));
        // Every signal of them is among the inputs, so the default is never taken.
        let tape = |all: &[Expr]| Tape::new(all, &inputs).unwrap_or_default();
        let place = |signal: Signal| signals.iter().position(|s| *s == signal);
        let row = |g: &Expr| {
            let is_own =
                |source: &ImpulseSource| matches!(source, ImpulseSource::Guard(of) if of == g);
            let own = system.impulses.iter().find(|i| is_own(&i.source))?;
            place(own.signal)
        };
        let jump_constants = system.impulses.iter().filter_map(|i| match i.source {
            ImpulseSource::Jump(constant) => {
                Some((place(i.signal)?, place(constant)? - states - laws))
            }
            ImpulseSource::Guard(_) => None,
        });
        let resets = switches.resets.iter();
        let resets = resets.filter_map(|r| StateJump::new(r, (states, laws), (signals, &inputs)));
        let compiled = LawSwitches {
            impulses: switches.guards.iter().map(row).collect(),
            follows_states: switches.guards.iter().map(follows).collect(),
            jump_constants: jump_constants.collect(),
            resets: resets.collect(),
            first: signals.len(),
            guards: tape(&switches.guards),
            slopes: tape(&slopes),
            states,
            exogenous: exogenous.len(),
            switches,
        };
        Some((smooth, compiled))
    }

    /// The row of the impulse of a guard.
    pub fn impulse(&self, switch: usize) -> Option<usize> {
        self.impulses[switch]
    }

    /// Number of switches.
    pub fn len(&self) -> usize {
        self.switches.len()
    }

    /// Whether a law jumps there and does not only bend.
    pub fn jumps(&self, switch: usize) -> bool {
        self.switches.jumps[switch]
    }

    pub fn signals(&self) -> Vec<Signal> {
        self.switches.signals()
    }

    /// A column with the switches of the laws as signals; one with a switch of its own stays as written.
    pub fn rewritten(&self, column: &Term, rates: &[Signal]) -> Expr {
        let switches = Switches::are_in(column);
        let column: Expr = column.clone().into();
        if !switches {
            return column;
        }
        let mut more = self.switches.clone();
        let smooth = more.rewritten(&column, rates);
        if more.len() == self.len() {
            smooth
        } else {
            column
        }
    }

    /// Guards at points, switches × `count`.
    pub fn guards(&self, points: &[f64], count: usize, out: &mut Vec<f64>, work: &mut Vec<f64>) {
        out.resize(self.len() * count, 0.0);
        self.guards.eval(points, count, out, work);
    }

    /// What stays at or above zero at points as long as these modes hold, switches × `count`.
    pub fn margins(
        &self,
        modes: &Modes,
        (points, count): (&[f64], usize),
        work: &mut Vec<f64>,
    ) -> Vec<f64> {
        let mut margins = Vec::new();
        self.guards(points, count, &mut margins, work);
        let sides = points[self.first * count..].chunks_exact(count);
        let rows = margins.chunks_exact_mut(count).zip(sides).zip(&modes.0);
        for ((margins, sides), mode) in rows {
            for (guard, side) in margins.iter_mut().zip(sides) {
                *guard = mode.margin(*guard, *side);
            }
        }
        margins
    }

    /// Sets σ at points to the sides on which they are: 0 where a guard is zero.
    pub fn set_sides(&self, points: &mut [f64], count: usize) {
        let (mut guards, mut work) = (Vec::new(), Vec::new());
        self.guards(points, count, &mut guards, &mut work);
        for (side, guard) in points[self.first * count..].iter_mut().zip(guards) {
            *side = Mode::of(guard).side();
        }
    }

    /// Whether a switch changes its side: `side` at the start, `guard` later. A guard of states that starts at zero is an event of its own.
    pub fn changes(&self, switch: usize, side: f64, guard: f64) -> bool {
        match side {
            0.0 => guard != 0.0 || self.follows_states[switch],
            _ => side * guard <= 0.0,
        }
    }

    /// Of each guard its derivatives by every state, then by every exogenous signal, rows over points.
    pub(super) fn gradients_at(&self, points: &[f64], count: usize, out: &mut Vec<f64>) {
        out.resize(self.slopes.outputs() * count, 0.0);
        self.slopes.eval(points, count, out, &mut Vec::new());
    }

    /// Derivatives of the guards at a single point.
    pub(super) fn gradients(&self, point: &[f64]) -> Gradients {
        let mut all = Vec::new();
        self.gradients_at(point, 1, &mut all);
        let mut out = Gradients::default();
        for row in all.chunks_exact(self.states + self.exogenous) {
            out.by_state.extend_from_slice(&row[..self.states]);
            out.by_exogenous.extend_from_slice(&row[self.states..]);
        }
        out
    }
}

impl Gradients {
    /// ∂g/∂z of a guard.
    pub fn of(&self, guard: usize, states: usize) -> &[f64] {
        &self.by_state[guard * states..(guard + 1) * states]
    }

    /// Whether a guard is so near zero that it counts as zero; `spread`: sizes of the states.
    pub fn is_on(&self, guard: usize, value: f64, spread: &[f64]) -> bool {
        let slopes = self.of(guard, spread.len()).iter().zip(spread);
        let size: f64 = slopes.map(|(slope, spread)| (slope * spread).abs()).sum();
        value.abs() <= SHOOTING.on_guard * size
    }
}
