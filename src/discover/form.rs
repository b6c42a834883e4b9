//! The found equations as a system that can be run: M(z) q = f(z) for the unknowns q, z everything known at an instant.
//!
//! q are the targets (highest derivatives, or next samples). Coupled equations contain each other's targets; where they do so
//! linearly, one small solve per instant gives q. Outputs are explicit and stand apart.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{DMatrix, DVector};

use super::{Discovery, Equation};
use crate::lang::model::VarKind;
use crate::term::{Atom, Signal, SignalNames, Term};

/// A system in mass-matrix form, and the order of its arguments.
#[derive(Clone, Debug, Default)]
pub struct Form {
    /// x: for each state with an equation, the signal and its derivatives below the target.
    pub state: Vec<Signal>,
    /// u: inputs and their derivatives, and states without an equation, as far as the equations mention them.
    pub inputs: Vec<Signal>,
    /// p: parameters that the equations mention.
    pub params: Vec<Signal>,
    /// h: lagged samples that the equations mention.
    pub history: Vec<Signal>,
    /// q, one per row.
    pub unknowns: Vec<Signal>,
    pub rows: Vec<Row>,
    /// Output maps, explicit.
    pub outputs: Vec<(Signal, Weighted)>,
    /// Place of each unknown's next lower derivative in ẋ, or in the next state: x\[i\]' is state\[i+1\] or an unknown.
    pub rates: Vec<Rate>,
}

/// Σ coefficient · term.
pub type Weighted = Vec<(f64, Term)>;

/// One equation: Σ_j mass\[j\]·q_j = force.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// (column j, Σ coefficient · term); the unit diagonal is included.
    pub mass: BTreeMap<usize, Weighted>,
    pub force: Weighted,
}

/// How one component of the state moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// By another component of the state.
    State(usize),
    /// By an unknown.
    Unknown(usize),
}

/// Why a discovery cannot be run as it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotRunnable {
    pub target: Signal,
    pub message: String,
}

impl Form {
    /// Sorts the equations into state, inputs and unknowns.
    ///
    /// # Errors
    /// An unknown that occurs other than linearly (inside a function, squared, or times another unknown).
    pub fn new(d: &Discovery) -> Result<Form, NotRunnable> {
        let mut form = Form::default();
        let (maps, dynamics): (Vec<_>, Vec<_>) =
            d.equations.iter().partition(|e| is_output(d, e.target));
        form.unknowns = dynamics.iter().map(|e| e.target).collect();
        form.state_vector();
        form.other_signals(d);
        for equation in dynamics {
            let row = form.row(d, equation)?;
            form.rows.push(row);
        }
        form.outputs = maps.iter().map(|e| (e.target, weighted(e))).collect();
        Ok(form)
    }

    /// True if some equation contains another's target, so that q needs a solve.
    pub fn coupled(&self) -> bool {
        self.rows.iter().enumerate().any(|(i, row)| {
            row.mass
                .iter()
                .any(|(j, w)| *j != i || w.iter().any(|(_, t)| !t.is_one()))
        })
    }

    /// M at one instant, n × n.
    pub fn mass(&self, at: &impl Fn(Signal) -> f64) -> DMatrix<f64> {
        let n = self.rows.len();
        DMatrix::from_fn(n, n, |i, j| {
            self.rows[i].mass.get(&j).map_or(0.0, |w| sum(w, at))
        })
    }

    /// q at one instant; `None` where M is singular.
    pub fn solve(&self, at: &impl Fn(Signal) -> f64) -> Option<Vec<f64>> {
        let force =
            DVector::from_iterator(self.rows.len(), self.rows.iter().map(|r| sum(&r.force, at)));
        let q = self.mass(at).lu().solve(&force)?;
        Some(q.iter().copied().collect())
    }

    /// ẋ (or the next x) from time, state, inputs, parameters and history, in the order of the fields.
    pub fn rates_at(&self, t: f64, x: &[f64], u: &[f64], p: &[f64], h: &[f64]) -> Option<Vec<f64>> {
        let at = self.lookup(t, x, u, p, h);
        let q = self.solve(&at)?;
        Some(
            self.rates
                .iter()
                .map(|r| match r {
                    Rate::State(i) => x[*i],
                    Rate::Unknown(i) => q[*i],
                })
                .collect(),
        )
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
        for e in &d.equations {
            for t in &e.terms {
                t.term.for_each_signal(&mut |s| {
                    seen.insert(s);
                });
            }
        }
        for s in seen {
            let taken = self.state.contains(&s) || self.unknowns.contains(&s) || s == Signal::TIME;
            match d.variable_of(s.var).map(|v| v.kind) {
                _ if taken => {}
                _ if s.shift < 0 => self.history.push(s),
                Some(VarKind::Param) => self.params.push(s),
                _ => self.inputs.push(s),
            }
        }
    }

    /// target − Σ (terms with unknowns) = Σ (the others).
    fn row(&self, d: &Discovery, e: &Equation) -> Result<Row, NotRunnable> {
        let mut row = Row::default();
        let own = self.unknowns.iter().position(|u| *u == e.target);
        if let Some(i) = own {
            row.mass.insert(i, vec![(1.0, Term::one())]);
        }
        for (c, term) in weighted(e) {
            match self.split(&term) {
                Split::Free => row.force.push((c, term)),
                Split::Linear(j, rest) => row.mass.entry(j).or_default().push((-c, rest)),
                Split::Nonlinear(u) => {
                    return Err(NotRunnable {
                        target: e.target,
                        message: format!(
                            "the equation of {} is not linear in {}, so it cannot be solved for the highest derivatives",
                            d.name(e.target),
                            d.name(u)
                        ),
                    });
                }
            }
        }
        Ok(row)
    }

    fn split(&self, term: &Term) -> Split {
        let mut found: Option<usize> = None;
        for (atom, power) in term.factors() {
            let mut inside = None;
            atom.for_each_signal(&mut |s| {
                inside = inside.or(self.unknowns.iter().position(|u| *u == s))
            });
            let Some(j) = inside else { continue };
            let plain = matches!(atom, Atom::Signal(_)) && power == 1.0;
            if !plain || found.is_some() {
                return Split::Nonlinear(self.unknowns[j]);
            }
            found = Some(j);
        }
        match found {
            None => Split::Free,
            Some(j) => {
                let without = Term::signal(self.unknowns[j]).pow(-1.0);
                Split::Linear(j, term.mul(&without))
            }
        }
    }
}

enum Split {
    Free,
    Linear(usize, Term),
    Nonlinear(Signal),
}

fn is_output(d: &Discovery, s: Signal) -> bool {
    d.variable_of(s.var)
        .is_some_and(|v| v.kind == VarKind::Output)
}

fn weighted(e: &Equation) -> Weighted {
    e.terms
        .iter()
        .map(|t| (t.coefficient, t.term.clone()))
        .collect()
}

fn sum(w: &Weighted, at: &impl Fn(Signal) -> f64) -> f64 {
    w.iter().map(|(c, t)| c * t.eval(at)).sum()
}
