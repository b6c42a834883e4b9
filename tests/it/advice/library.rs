//! Advice on the model: its libraries and constraints.

use sidc_testing::attacks::{Attack, case};
use sidc_testing::program::file;
use sidc_testing::records::joined;

use super::experiment::{motion, read, record, swing};
use super::follow::{Case, Scenario};

/// Two coupled carts with a different constraint.
fn carts(constraint: &str) -> Case {
    let text = file("models/two_carts.sid");
    let free = text.lines().filter(|l| !l.starts_with("constrain"));
    let free: String = free.map(|l| format!("{l}\n")).collect();
    let model = format!("{free}{constraint}\n");
    Case::new(&model, file("models/data/two_carts.csv"))
}

/// The constraint is removed.
fn without(constraint: &'static str, case: Case) -> Scenario {
    Scenario::words(case, move |case, _| case.rewritten(constraint, ""))
}

pub fn at_bound() -> Scenario {
    let bound = "constrain coef(ddx1, dx1) >= -0.29";
    without(bound, carts(bound))
}

pub fn constraint_strained() -> Scenario {
    let value = "constrain coef(ddx1, x1) = -19.1";
    without(value, carts(value))
}

/// The equation of y cannot be found, because y is constant.
pub fn constraint_broken() -> Scenario {
    let tie = "constrain coef(dx, x) = coef(dy, y)";
    let model = format!("state x, y\ndx ~ poly(x; 2)\ndy ~ <x, y>\n{tie}\n");
    let [x] = motion(|_, x: &[f64; 1]| [-0.5 * x[0]], [1.0], 0.05, 100);
    let (one, zero) = (vec![1.0; 100], vec![0.0; 100]);
    let table = record(0.05, &[("x", &x), ("y", &one), ("dy", &zero)]);
    without(tie, Case::new(&model, table)).doubted()
}

/// A Taylor series of a sine, with a last term that the data do not show.
pub fn better_without() -> Scenario {
    let rate = |_: f64, z: &[f64; 2]| [z[1], -6.8 * z[0].sin() - 0.24 * z[1]];
    let [x, _] = motion(rate, [0.26, 0.0], 0.03, 600);
    let model = "state x : order 2\nddx ~ poly(x, dx; 5)\n";
    Scenario::change(Case::new(model, record(0.03, &[("x", &x)]))).doubted()
}

pub fn beyond_library() -> Scenario {
    let lacking = case(Attack::MissingTerm, 1, 0.01);
    Scenario::change(Case::new(&lacking.model, lacking.runs[0].csv()))
}

/// The sum of four states is conserved, so the libraries of three of them contain the same functions.
pub fn dependent_states() -> Scenario {
    let rate = |_: f64, z: &[f64; 4]| {
        let (new, ill, well) = (0.28 * z[0] * z[2], 0.47 * z[1], 0.3 * z[2]);
        [-new, new - ill, ill - well, well]
    };
    let states = motion(rate, [0.6, 0.3, 0.09, 0.01], 0.02, 500);
    let [s, e, i, r] = [0, 1, 2, 3].map(|k| read(&states[k], 1e-3, k as u64));
    let table = record(0.02, &[("S", &s), ("E", &e), ("I", &i), ("R", &r)]);
    let model = "state S, E, I, R\ndS, dE, dI, dR ~ poly(S, E, I, R; 2)\n";
    Scenario::words(Case::new(model, table), |case, _| {
        case.rewritten("poly(S, E, I, R; 2)", "poly(S, E, I; 2)")
    })
}

/// Two noisy records of dx = sin x, and a cubic library.
fn sine(sigma: f64) -> Case {
    let one = |start: f64, seed: u64| {
        let [x] = motion(|_, x: &[f64; 1]| [x[0].sin()], [start], 0.02, 300);
        record(0.02, &[("x", &read(&x, sigma, seed))])
    };
    let case = Case::new("state x\ndx ~ poly(x; 3)\n", String::new());
    case.recorded(vec![one(-3.0, 1), one(0.05, 2)])
}

pub fn exhausted_library() -> Scenario {
    Scenario::change(sine(0.0))
}

pub fn misfit() -> Scenario {
    Scenario::change(sine(0.002))
}

pub fn no_trajectory() -> Scenario {
    let x = read(&swing(2.5, 0.02, 400), 0.01, 1);
    let model = "state x : order 2\nddx ~ <cos x, 1> + poly(dx; 3)\n";
    Scenario::change(Case::new(model, record(0.02, &[("x", &x)])))
}

/// A van der Pol oscillator without the term that limits it.
pub fn poor_fit() -> Scenario {
    let rate = |_: f64, z: &[f64; 2]| [z[1], (1.0 - z[0] * z[0]) * z[1] - z[0]];
    let [x, _] = motion(rate, [1.0, 0.0], 0.05, 400);
    let model = "state x : order 2\nddx ~ <x, dx>\n";
    Scenario::change(Case::new(model, record(0.05, &[("x", &x)])))
}

/// A mass on a spring, with an input that is declared but in no library.
pub fn forgotten_input() -> Scenario {
    pushed("state x : order 2\ninput u : linear\nddx ~ <x, dx, x^3>\n")
}

/// The same, with a column for the input that the model does not read.
pub fn unread_input() -> Scenario {
    pushed("state x : order 2\nddx ~ <x, dx, x^3>\n")
}

fn pushed(model: &str) -> Scenario {
    let push = |t: f64| (1.3 * t).sin() + 0.7 * (0.31 * t * t).cos();
    let rate = |t: f64, z: &[f64; 2]| [z[1], 2.0 * push(t) - 3.0 * z[0] - 0.4 * z[1]];
    let [x, _] = motion(rate, [1.0, 0.0], 0.05, 400);
    let u: Vec<f64> = (0..400).map(|k| push(0.05 * k as f64)).collect();
    Scenario::change(Case::new(model, record(0.05, &[("x", &x), ("u", &u)])))
}

/// A pendulum on a cart, without the accelerations that couple the two.
pub fn coupled_bodies() -> Scenario {
    let rate = |t: f64, z: &[f64; 4]| {
        let [_, dx, q, dq] = *z;
        let force = 3.0 * (1.3 * t).sin() + 2.0 * (3.1 * t).sin() - 0.2 * dx;
        // 2 ddx + ddq cos q = force + dq² sin q,  ddx cos q + ddq = −9.8 sin q − 0.1 dq
        let (cart, rod) = (force + dq * dq * q.sin(), -9.8 * q.sin() - 0.1 * dq);
        let det = 2.0 - q.cos() * q.cos();
        [
            dx,
            (cart - rod * q.cos()) / det,
            dq,
            (2.0 * rod - cart * q.cos()) / det,
        ]
    };
    let step = 0.04;
    let states = motion(rate, [0.0, 0.0, 0.5, 0.0], step, 400);
    let rates: Vec<[f64; 4]> = (0..400)
        .map(|k| rate(k as f64 * step, &states.each_ref().map(|s| s[k])))
        .collect();
    let read = |of: usize| -> Vec<f64> { rates.iter().map(|r| r[of]).collect() };
    let force: Vec<f64> = (0..400)
        .map(|k| k as f64 * step)
        .map(|t| 3.0 * (1.3 * t).sin() + 2.0 * (3.1 * t).sin())
        .collect();
    let [x, dx, q, dq] = &states;
    let table = record(
        step,
        &[
            ("x", x),
            ("dx", dx),
            ("q", q),
            ("dq", dq),
            ("ddx", &read(1)),
            ("ddq", &read(3)),
            ("F", &force),
        ],
    );
    let own = "<dx, dq, F> + <1, dq^2> * <sin q, cos q>";
    let model = format!("state x, q : order 2\ninput F : linear\nddx, ddq ~ {own}\n");
    Scenario::change(Case::new(&model, table))
}

/// An inverted pendulum between soft stops.
pub fn run_leaves_data() -> Scenario {
    let rate = |_: f64, z: &[f64; 2]| {
        let stop = (z[0].abs() - 1.0).max(0.0) * z[0].signum();
        [z[1], 4.0 * z[0] - 40.0 * stop - 0.05 * z[1]]
    };
    let [x, _] = motion(rate, [0.05, 0.0], 0.02, 600);
    let case = Case::new(
        "state x : order 2\nddx ~ <x, dx>\n",
        record(0.02, &[("x", &x)]),
    );
    Scenario::words(case.option("--holdout=25%"), |case, _| {
        case.rewritten("<x, dx>", "<x, dx, max(abs(x) - 1, 0)*sign(x)>")
    })
}

/// Two bodies, the first of which is pushed by a force that neither library has.
pub fn same_relation() -> Scenario {
    let own = "<x, y, dx, dy, x^2, y^2>";
    let model =
        format!("state x, y : order 2\ninput u : hold\nddx ~ {own} + <ddy>\nddy ~ {own} + <ddx>\n");
    let case = Case::new(&model, joined(0.3, [4.0, 9.0, 0.0], 3));
    Scenario::words(case, |case, _| case.rewritten("<ddy>", "<ddy, u>"))
}
