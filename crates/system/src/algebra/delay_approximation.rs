//! Delayed inputs as ordinary equations, so that a linear system has finitely many states: the Padé approximant of second order.
//!
//! In: a discovery whose inputs act late. Out: the same with two states more for each such input, in which no input is delayed.
//! exp(−τs) ≈ (1 − τs/2 + τ²s²/12)/(1 + τs/2 + τ²s²/12), whose phase is off by 1 % at ωτ = 2.

use crate::discovery::{Discovery, Equation, FoundTerm, Status, Variable};
use sidc_lang::model::VarKind;
use sidc_lang::term::{Atom, Expr, Signal, Term, VarId};

/// An input that acts late, and the state that stands for its delay.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayState {
    pub input: Signal,
    pub seconds: f64,
    /// z with z̈ = u − (6/τ) ż − (12/τ²) z; what acts is u − (12/τ) ż.
    pub state: Signal,
}

impl DelayState {
    /// The value of the state where the input rests at `input`.
    pub fn at_rest(&self, input: f64) -> f64 {
        input * self.seconds * self.seconds / 12.0
    }
}

/// The discovery with approximants in place of its delays, and what they are; unchanged if no input acts later than recorded.
pub fn delays_as_states(d: &Discovery) -> (Discovery, Vec<DelayState>) {
    let mut out = d.clone();
    let mut added = Vec::new();
    for (place, variable) in d.variables.iter().enumerate() {
        let var = VarId(place as u16);
        let seconds = d.input_delay(var);
        if seconds > 0.0 && variable.kind == VarKind::Input {
            let state = Signal::new(VarId(out.variables.len() as u16));
            out.variables.push(Variable {
                name: unused_name(&out, &variable.name),
                kind: VarKind::State,
                order: 2,
                unit: None,
            });
            added.push(DelayState {
                input: Signal::new(var),
                seconds,
                state,
            });
        }
    }
    for equation in &mut out.equations {
        equation.terms = equation
            .terms
            .iter()
            .flat_map(|t| replaced(t, &added))
            .collect();
    }
    out.equations.extend(added.iter().map(approximant));
    (out, added)
}

fn unused_name(d: &Discovery, input: &str) -> String {
    let mut name = format!("{input}_delay");
    while d.variables.iter().any(|v| v.name == name) {
        name.push('_');
    }
    name
}

/// z̈ = u − (6/τ) ż − (12/τ²) z
fn approximant(delay: &DelayState) -> Equation {
    let term = |s: Signal, coefficient: f64| FoundTerm {
        term: Term::signal(s),
        coefficient,
        fixed: true,
        standard_error: None,
        evidence: None,
        runs: Vec::new(),
    };
    let der = |der| Signal::derivative(delay.state.var, der);
    let tau = delay.seconds;
    Equation {
        target: der(2),
        terms: vec![
            term(delay.input, 1.0),
            term(der(1), -6.0 / tau),
            term(der(0), -12.0 / (tau * tau)),
        ],
        status: Status::Known,
        reasons: Vec::new(),
        evidence: None,
        path: Vec::new(),
    }
}

/// A term with the inputs as they act.
fn replaced(t: &FoundTerm, delays: &[DelayState]) -> Vec<FoundTerm> {
    if !delays.iter().any(|delay| t.term.mentions(delay.input)) {
        return vec![t.clone()];
    }
    let expr = in_term(&t.term, delays);
    let parts = expr.terms().map(|(weight, term)| FoundTerm {
        term: term.clone(),
        coefficient: weight * t.coefficient,
        ..t.clone()
    });
    parts.collect()
}

fn in_term(term: &Term, delays: &[DelayState]) -> Expr {
    let factors = term.factors();
    let factors = factors.map(|(atom, power)| in_atom(atom, delays).pow(power));
    factors.fold(Expr::number(1.0), |product, factor| product * factor)
}

fn in_atom(atom: &Atom, delays: &[DelayState]) -> Expr {
    match atom {
        Atom::Signal(s) => match delays.iter().find(|d| d.input == *s) {
            Some(delay) => {
                let rate = Expr::signal(Signal::derivative(delay.state.var, 1));
                Expr::signal(*s) - rate.scale(12.0 / delay.seconds)
            }
            None => Expr::signal(*s),
        },
        Atom::Call(f, args) => Expr::call(*f, args.iter().map(|a| in_expr(a, delays)).collect()),
        Atom::Sum(e) => in_expr(e, delays),
    }
}

fn in_expr(e: &Expr, delays: &[DelayState]) -> Expr {
    let terms = e.terms();
    terms
        .map(|(weight, term)| in_term(term, delays).scale(weight))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{Point, linear};
    use crate::discovery::{Evidence, Form, InputDelay, JointEvidence};

    /// ẋ = −x + 3 u(t − 0.2)
    fn late() -> Discovery {
        let variable = |name: &str, kind, order| Variable {
            name: name.into(),
            kind,
            order,
            unit: None,
        };
        let (x, u) = (Signal::new(VarId(1)), Signal::new(VarId(2)));
        let term = |s, coefficient| FoundTerm {
            term: Term::signal(s),
            coefficient,
            fixed: false,
            standard_error: None,
            evidence: None,
            runs: Vec::new(),
        };
        let delay = InputDelay {
            input: "u".into(),
            seconds: 0.2,
            samples: 2.0,
        };
        let together = JointEvidence {
            delays: vec![delay],
            ..JointEvidence::default()
        };
        Discovery {
            variables: vec![
                variable("t", VarKind::Time, 0),
                variable("x", VarKind::State, 1),
                variable("u", VarKind::Input, 0),
            ],
            equations: vec![Equation {
                target: Signal::derivative(VarId(1), 1),
                terms: vec![term(x, -1.0), term(u, 3.0)],
                status: Status::Pass,
                reasons: Vec::new(),
                evidence: Some(Evidence {
                    joint: Some(together),
                    ..Evidence::default()
                }),
                path: Vec::new(),
            }],
            ..Discovery::default()
        }
    }

    #[test]
    fn the_frequency_response_is_that_of_the_delay() {
        let (d, delays) = delays_as_states(&late());
        assert_eq!((delays.len(), delays[0].seconds), (1, 0.2));
        let l = linear(&Form::new(&d), &Point::default()).unwrap();
        assert_eq!((l.a.nrows(), l.b.ncols()), (3, 1));
        // (iω − A)⁻¹ B of the first state, against 3 exp(−0.2 iω)/(1 + iω) at ω = 5.
        let omega = 5.0;
        let n = l.a.nrows();
        let system = nalgebra::DMatrix::from_fn(2 * n, 2 * n, |i, j| {
            let (row, column) = (i % n, j % n);
            let turned = if row == column { omega } else { 0.0 };
            match (i < n, j < n) {
                (true, true) | (false, false) => -l.a[(row, column)],
                (true, false) => -turned,
                (false, true) => turned,
            }
        });
        let right = nalgebra::DVector::from_fn(2 * n, |i, _| if i < n { l.b[(i, 0)] } else { 0.0 });
        let z = system.lu().solve(&right).unwrap();
        let size = 3.0 / (1.0 + omega * omega).sqrt();
        let phase = -0.2 * omega - omega.atan();
        assert!((z[0] - size * phase.cos()).abs() < 2e-3 * size, "{}", z[0]);
        assert!((z[n] - size * phase.sin()).abs() < 2e-3 * size, "{}", z[n]);
    }

    #[test]
    fn inputs_within_functions_are_replaced_and_others_stay() {
        let mut d = late();
        let u = Expr::signal(Signal::new(VarId(2)));
        let (_, term) = (u.clone() * u).into_term();
        d.equations[0].terms[1].term = term;
        let (out, delays) = delays_as_states(&d);
        let rest = |s: Signal| match s {
            s if s == delays[0].input => 2.0,
            s if s == delays[0].state => delays[0].at_rest(2.0),
            _ => 0.0,
        };
        let value: f64 = out.equations[0]
            .terms
            .iter()
            .map(|t| t.coefficient * t.term.eval(&rest))
            .sum();
        assert!((value - 12.0).abs() < 1e-12);
        let held: f64 = out.equations[1]
            .terms
            .iter()
            .map(|t| t.coefficient * t.term.eval(&rest))
            .sum();
        assert!(held.abs() < 1e-12);
        let mut plain = late();
        plain.equations[0].evidence = None;
        assert!(delays_as_states(&plain).1.is_empty());
    }
}
