//! Mass-matrix form: the found equations as M(z, q) q = f(z, q), with unknowns q, and z all that is known at an
//! instant.
//!
//! q are the targets: highest derivatives, or next samples. Equations are coupled if they contain each other's
//! targets. If they do so linearly, M and f depend on z alone and one linear solve gives q; else the solve is
//! iterated, which is Newton's method. Outputs are explicit.

use crate::discovery::thresholds::NEWTON;
use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector};

use crate::discovery::{Discovery, Equation};
use sidc_lang::model::{Reset, VarKind};
use sidc_lang::term::{Expr, Signal, Term};

/// A system in mass-matrix form, and the order of its arguments.
#[derive(Clone, Debug, Default)]
pub struct Form {
    /// x: for each state with an equation, the signal and its derivatives below the target.
    pub state: Vec<Signal>,
    /// u: inputs, their derivatives, and states without an equation, if the equations mention them.
    pub inputs: Vec<Signal>,
    /// p: parameters, and unknown constants that have no value, if the equations mention them.
    pub params: Vec<Signal>,
    /// Unknown constants that have a value, if the equations mention them; empty where that value stands in their place.
    pub constants: Vec<Signal>,
    /// h: lagged samples, if the equations mention them.
    pub history: Vec<Signal>,
    /// q, one for each row.
    pub unknowns: Vec<Signal>,
    pub rows: Vec<Row>,
    /// Outputs, explicit.
    pub outputs: Vec<(Signal, Expr)>,
    /// What gives the rate of each component of the state: x\[i\]' is state\[i+1\] or an unknown.
    pub rates: Vec<Rate>,
    /// True if M and f do not depend on q.
    pub linear: bool,
    /// Where x jumps.
    pub resets: Vec<Reset>,
}

/// One equation, target = right, as Σ_j mass\[j\]·q_j = force.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// The equation's right side as it was found, unknowns included.
    pub right: Expr,
    /// ∂(target − right)/∂q_j for each unknown.
    pub mass: Vec<Expr>,
    /// right − Σ_j ∂right/∂q_j · q_j: free of unknowns if they occur linearly.
    pub force: Expr,
}

/// What gives the rate of one component of the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// Another component.
    State(usize),
    /// An unknown.
    Unknown(usize),
}

impl Rate {
    /// The rate, given state and unknowns.
    pub fn value(self, x: &[f64], q: &[f64]) -> f64 {
        match self {
            Rate::State(i) => x[i],
            Rate::Unknown(i) => q[i],
        }
    }
}

impl Form {
    /// Sorts the signals of the equations into state, inputs and unknowns. Unknown constants are the numbers that were found.
    pub fn new(d: &Discovery) -> Form {
        let mut form = Form::of(d, &|e| match d.unknowns.is_empty() {
            true => e,
            false => e.with_values(&|s| d.unknown_value(s)),
        });
        form.constants.clear();
        form
    }

    /// The same with unknown constants by name.
    pub fn symbolic(d: &Discovery) -> Form {
        Form::of(d, &|e| e)
    }

    fn of(d: &Discovery, valued: &impl Fn(Expr) -> Expr) -> Form {
        let right = |e: &Equation| valued(right(e));
        let mut form = Form::default();
        let (maps, dynamics): (Vec<_>, Vec<_>) =
            d.equations.iter().partition(|e| is_output(d, e.target));
        form.unknowns = dynamics.iter().map(|e| e.target).collect();
        form.state_vector();
        form.other_signals(d);
        form.rows = dynamics
            .iter()
            .map(|e| form.row(right(e), e.target))
            .collect();
        form.linear = form.rows.iter().all(|r| form.free(r));
        let resets = d.resets.iter();
        form.resets = resets.map(|r| r.map(&|e| valued(e.clone()))).collect();
        form.outputs = maps.iter().map(|e| (e.target, right(e))).collect();
        form
    }

    /// True if some equation contains another's target, so that q needs a linear solve.
    pub fn coupled(&self) -> bool {
        self.rows.iter().enumerate().any(|(i, row)| {
            let unit = |j| if i == j { 1.0 } else { 0.0 };
            let mut mass = row.mass.iter().enumerate();
            mass.any(|(j, m)| m.as_number() != Some(unit(j)))
        })
    }

    /// M at one instant, n × n. `at` must know q if M depends on it.
    pub fn mass(&self, at: &impl Fn(Signal) -> f64) -> DMatrix<f64> {
        let n = self.rows.len();
        DMatrix::from_fn(n, n, |i, j| self.rows[i].mass[j].eval(at))
    }

    /// q at one instant. `None` where M is singular or Newton's method from `start` does not converge.
    pub fn solve(&self, at: &impl Fn(Signal) -> f64, start: &[f64]) -> Option<Vec<f64>> {
        let mut q = start.to_vec();
        for _ in 0..NEWTON.iterations {
            let with_q = |s: Signal| match self.unknowns.iter().position(|u| *u == s) {
                Some(j) => q[j],
                None => at(s),
            };
            let force = self.rows.iter().map(|r| r.force.eval(&with_q));
            let force = DVector::from_iterator(self.rows.len(), force);
            let next = self.mass(&with_q).lu().solve(&force)?;
            let moved = next.iter().zip(&q).map(|(a, b)| (a - b).abs());
            let (moved, size) = (moved.fold(0.0, f64::max), next.amax());
            q = next.iter().copied().collect();
            if self.linear || moved <= NEWTON.step * size {
                return Some(q);
            }
            if !size.is_finite() {
                return None;
            }
        }
        None
    }

    /// ẋ (or the next x) from time, state, inputs, parameters and history, in the order of the fields. Newton's method
    /// starts at q = 0.
    pub fn rates_at(&self, t: f64, x: &[f64], u: &[f64], p: &[f64], h: &[f64]) -> Option<Vec<f64>> {
        let at = self.lookup(t, x, u, p, h);
        let q = self.solve(&at, &vec![0.0; self.rows.len()])?;
        Some(self.rates.iter().map(|r| r.value(x, &q)).collect())
    }

    fn lookup<'a>(
        &'a self,
        t: f64,
        x: &'a [f64],
        u: &'a [f64],
        p: &'a [f64],
        h: &'a [f64],
    ) -> impl Fn(Signal) -> f64 + 'a {
        let places = [
            (&self.state, x),
            (&self.inputs, u),
            (&self.params, p),
            (&self.history, h),
        ];
        move |s| {
            if s == Signal::TIME {
                return t;
            }
            places
                .iter()
                .find_map(|(names, values)| {
                    let i = names.iter().position(|n| *n == s)?;
                    values.get(i).copied()
                })
                .unwrap_or(f64::NAN)
        }
    }

    fn state_vector(&mut self) {
        for (i, q) in self.unknowns.iter().enumerate() {
            let lower = if q.shift == 0 { q.der } else { 1 };
            for der in 0..lower {
                let last = der + 1 == lower;
                let here = self.state.len();
                self.state.push(Signal::derivative(q.var, der));
                self.rates.push(if last {
                    Rate::Unknown(i)
                } else {
                    Rate::State(here + 1)
                });
            }
        }
    }

    fn other_signals(&mut self, d: &Discovery) {
        let mut seen = BTreeSet::new();
        let mut see = |s: Signal| {
            seen.insert(s);
        };
        for e in &d.equations {
            e.terms
                .iter()
                .for_each(|t| t.term.for_each_signal(&mut see));
        }
        for e in d.resets.iter().flat_map(Reset::expressions) {
            e.for_each_signal(&mut see);
        }
        for s in seen {
            let taken = self.state.contains(&s) || self.unknowns.contains(&s) || s == Signal::TIME;
            match d.variable_of(s.var).map(|v| v.kind) {
                _ if taken => {}
                _ if s.shift < 0 => self.history.push(s),
                Some(VarKind::Param) => self.params.push(s),
                Some(VarKind::Unknown) if d.unknown_value(s).is_some() => self.constants.push(s),
                Some(VarKind::Unknown) => self.params.push(s),
                _ => self.inputs.push(s),
            }
        }
    }

    pub(crate) fn row(&self, right: Expr, target: Signal) -> Row {
        let slopes = self.unknowns.iter().map(|q| right.derivative(*q));
        let slopes: Vec<Expr> = slopes.collect();
        let mut force = right.clone();
        for (q, slope) in self.unknowns.iter().zip(&slopes) {
            force = force - multiplied(slope, *q);
        }
        let unit = |q: &Signal| Expr::number(if *q == target { 1.0 } else { 0.0 });
        let mass = self.unknowns.iter().zip(slopes);
        Row {
            mass: mass.map(|(q, slope)| unit(q) - slope).collect(),
            right,
            force,
        }
    }

    /// True if neither M nor f of this row contains an unknown.
    pub fn free(&self, row: &Row) -> bool {
        let knows = |e: &Expr| self.unknowns.iter().any(|q| e.mentions(*q));
        !knows(&row.force) && !row.mass.iter().any(knows)
    }
}

/// Term by term, so that a linear occurrence cancels exactly.
fn multiplied(e: &Expr, s: Signal) -> Expr {
    let times = |(weight, term): (f64, &Term)| Expr::from((weight, term.mul(&Term::signal(s))));
    e.terms().map(times).sum()
}

fn is_output(d: &Discovery, s: Signal) -> bool {
    d.variable_of(s.var)
        .is_some_and(|v| v.kind == VarKind::Output)
}

fn right(e: &Equation) -> Expr {
    let parts = e.terms.iter();
    parts
        .map(|t| Expr::from((t.coefficient, t.term.clone())))
        .sum()
}
