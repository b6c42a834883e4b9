//! Systems of a fitted trajectory: no independent law is searched for, but copies are doubted.

use super::*;
use sidc_data::{Column, Origin};
use sidc_lang::model::VarKind;
use sidc_lang::term::{Func, VarId};
use sidc_system::discovery::{Evidence, FoundTerm, JointEvidence, Variable};

const X: Signal = Signal::derivative(VarId(1), 2);
const TURN: Signal = Signal::derivative(VarId(2), 2);
const ANGLE: Signal = Signal::new(VarId(2));
const FORCE: Signal = Signal::new(VarId(3));

fn of_angle(name: &str) -> Term {
    let call = Func::named(name).map(|f| Expr::call(f, vec![Expr::signal(ANGLE)]));
    call.unwrap_or_else(Expr::zero).into_term().1
}

fn equation(target: Signal, terms: &[(f64, Term)]) -> Equation {
    let found = |(coefficient, term): &(f64, Term)| FoundTerm {
        term: term.clone(),
        coefficient: *coefficient,
        fixed: false,
        standard_error: Some(1e-3 * coefficient.abs()),
        evidence: None,
        runs: Vec::new(),
    };
    Equation {
        target,
        terms: terms.iter().map(found).collect(),
        status: Status::Pass,
        reasons: Vec::new(),
        evidence: Some(Evidence {
            joint: Some(JointEvidence::default()),
            ..Evidence::default()
        }),
        path: Vec::new(),
    }
}

fn variable(name: &str, kind: VarKind) -> Variable {
    Variable {
        name: name.into(),
        kind,
        order: 2,
        unit: None,
    }
}

/// θ̈ = −20 sin θ − 2 ẍ cos θ with a law of the cart, along a motion that obeys the first.
fn judged(cart: &[(f64, Term)]) -> Discovery {
    let pendulum = [
        (-20.0, of_angle("sin")),
        (-2.0, Term::signal(X).mul(&of_angle("cos"))),
    ];
    let mut d = Discovery {
        variables: vec![
            variable("t", VarKind::Time),
            variable("x", VarKind::State),
            variable("theta", VarKind::State),
            variable("u", VarKind::Input),
        ],
        equations: vec![equation(X, cart), equation(TURN, &pendulum)],
        ..Discovery::default()
    };
    let wave = |a: f64, w: f64| (0..200).map(move |k| a * (w * f64::from(k)).sin());
    let angle: Vec<f64> = wave(0.2, 0.13).collect();
    let x: Vec<f64> = wave(1.5, 0.31).collect();
    let turn = x.iter().zip(&angle);
    let turn: Vec<f64> = turn
        .map(|(x, a)| -20.0 * a.sin() - 2.0 * x * a.cos())
        .collect();
    let all = [
        (X, x),
        (TURN, turn),
        (ANGLE, angle),
        (FORCE, wave(2.0, 0.07).collect()),
    ];
    let mut columns: Vec<Column> = all
        .map(|(signal, values)| Column {
            signal,
            values,
            origin: Origin::Measured { noise: None },
        })
        .into();
    columns.sort_by_key(|c| c.signal);
    let samples = Samples {
        trajectory: vec![0; 200],
        time: (0..200).map(f64::from).collect(),
        columns,
    };
    doubt_redundant_equations(&mut d, &samples, None);
    d
}

#[test]
fn a_copy_of_a_fitted_trajectory_is_doubted() {
    let over = of_angle("cos").pow(-1.0);
    let copy = [
        (-10.0, of_angle("sin").mul(&over)),
        (-0.5, Term::signal(TURN).mul(&over)),
    ];
    let d = judged(&copy);
    let codes: Vec<&str> = (d.equations.iter().flat_map(|e| &e.reasons))
        .map(|r| r.code.as_str())
        .collect();
    assert_eq!(codes, ["same-relation"; 2]);
    let text = &d.equations[0].reasons[0].text;
    assert!(
        text.starts_with("the equation of ddx is that of ddtheta solved for ddx"),
        "{text}"
    );
    assert!(text.contains("physics of ddx is missing from its library"));
}

#[test]
fn a_law_of_a_fitted_trajectory_is_left_alone() {
    let law = [
        (1.3, Term::signal(FORCE)),
        (-0.18, Term::signal(TURN).mul(&of_angle("cos"))),
    ];
    let d = judged(&law);
    assert!(d.equations.iter().all(|e| e.status == Status::Pass));
}
