//! Advice on the records: how long, and of which motion.

use sidc_testing::records::bounces;

use super::experiment::{levels, motion, normal, read, record, swing};
use super::follow::{Case, Scenario, figure};

const PENDULUM: &str = "state x : order 2\nddx ~ <sin x, cos x, 1> + poly(dx; 2)\n";

/// A noisy pendulum swing, as a table.
fn swung(start: f64, step: f64, rows: usize, sigma: f64) -> String {
    record(step, &[("x", &read(&swing(start, step, rows), sigma, 1))])
}

/// Values near 1000 that vary by some hundred-thousandths, so that the columns x and 1 are nearly equal.
pub fn dependent_support() -> Scenario {
    let table = |size: f64| {
        let decay: Vec<f64> = (0..200)
            .map(|k| size * (-0.05 * f64::from(k)).exp())
            .collect();
        let x: Vec<f64> = decay.iter().map(|d| 1000.0 + d).collect();
        let dx: Vec<f64> = x.iter().map(|x| 1000.0 - x).collect();
        record(0.05, &[("x", &x), ("dx", &dx)])
    };
    let case = Case::new("state x\ndx ~ <1, x>\n", table(3e-5));
    Scenario::words(case, move |case, _| case.recorded(vec![table(1.0)]))
}

pub fn few_rows() -> Scenario {
    let case = Case::new(PENDULUM, swung(2.5, 0.2, 10, 0.01));
    Scenario::words(case, |case, reason| {
        let rows = figure(reason, "record ") as usize;
        case.recorded(vec![swung(2.5, 0.2, rows, 0.01)])
    })
}

pub fn no_motion() -> Scenario {
    let case = Case::new(PENDULUM, swung(0.0, 0.02, 400, 0.01));
    Scenario::words(case, |case, _| {
        case.recorded(vec![swung(2.5, 0.02, 400, 0.01)])
    })
}

/// Small swings do not show that the spring hardens.
pub fn not_carried_over() -> Scenario {
    let swing = |start: f64, rows: usize, seed: u64| {
        let rate = |_: f64, z: &[f64; 2]| [z[1], -4.0 * z[0] - z[0].powi(3) - 0.05 * z[1]];
        let [x, _] = motion(rate, [start, 0.0], 0.05, rows);
        record(0.05, &[("x", &read(&x, 0.001, seed))])
    };
    let model = "state x : order 2\nddx ~ poly(x, dx; 3)\n";
    let case = Case {
        held_out: Some(swing(1.5, 300, 6)),
        ..Case::new(model, swing(0.1, 200, 1))
    };
    Scenario::words(case, move |case, _| {
        case.recorded(vec![swing(0.1, 200, 1), swing(2.0, 300, 5)])
    })
}

pub fn not_sparse() -> Scenario {
    let table = |rows: usize| {
        let (x, z) = (normal(rows, 1), normal(rows, 2));
        let rate = |(x, z): (&f64, &f64)| 2.0 * x - z + x.powi(3);
        let dx: Vec<f64> = x.iter().zip(&z).map(rate).collect();
        record(1.0, &[("x", &x), ("z", &z), ("dx", &dx)])
    };
    let case = Case::new("state x, z\ndx ~ poly(x, z; 3)\n", table(8));
    Scenario::words(case, move |case, reason| {
        let more = figure(reason, "record ") as usize;
        case.recorded(vec![table(8 + more)])
    })
}

/// A steady oscillation under one sine, then arbitrary excitation.
pub fn relation() -> Scenario {
    let step = 0.03;
    let read = |x: &[f64], u: &[f64]| record(step, &[("x", &read(x, 0.002, 1)), ("u", u)]);
    let rate = |x: f64, dx: f64, u: f64| -6.0 * x - 0.3 * dx + 2.0 * u;
    let sine = |t: f64| (1.7 * t).sin();
    let steady = |t: f64, z: &[f64; 2]| [z[1], rate(z[0], z[1], sine(t))];
    let [x, _] = motion(steady, [1.0, 0.0], step, 3600);
    let u: Vec<f64> = (0..3600).map(|k| sine(step * f64::from(k))).collect();
    let model = "state x : order 2\ninput u : linear\nddx ~ <x, dx, u>\n";
    let case = Case::new(model, read(&x[3000..], &u[3000..]));
    let other = |t: f64| (1.7 * t).sin() + (4.3 * t).cos() + (0.6 * t).sin();
    let pushed = move |t: f64, z: &[f64; 2]| [z[1], rate(z[0], z[1], other(t))];
    let [x, _] = motion(pushed, [1.0, 0.0], step, 600);
    let u: Vec<f64> = (0..600).map(|k| other(step * f64::from(k))).collect();
    let excited = read(&x, &u);
    Scenario::words(case, move |case, _| case.recorded(vec![excited.clone()]))
}

/// A bouncing ball; the law holds between its impacts.
pub fn rows_missed() -> Scenario {
    let model = "state y : order 2\nddy ~ poly(y, dy; 2)\n";
    let table = record(0.01, &[("y", &bounces(401, 0.01))]);
    Scenario::change(Case::new(model, table))
}

/// A swing too small to distinguish the sine from the angle, and one as large as advised.
pub fn tie() -> Scenario {
    let model = "state x : order 2\nddx ~ <sin x, x, x^3, cos x, 1> + poly(dx; 2)\n";
    let case = Case::new(model, swung(0.02, 0.02, 800, 2e-4));
    Scenario::words(case, |case, reason| {
        let reach = figure(reason, "reach |x| > ");
        case.recorded(vec![swung(1.05 * reach, 0.02, 800, 2e-4)])
    })
}

pub fn uncertain_coefficient() -> Scenario {
    let step = 0.05;
    let table = move |rows: usize| {
        let (u, w) = (levels(rows, 10, 2), levels(rows, 7, 5));
        let rate = |(u, w): (&f64, &f64)| 2.0 * u + 0.035 * w;
        let dx: Vec<f64> = u.iter().zip(&w).map(rate).collect();
        let dx = read(&dx, 0.05, 3);
        let x = normal(rows, 4);
        record(step, &[("x", &x), ("u", &u), ("w", &w), ("dx", &dx)])
    };
    let rows = 80;
    let case = Case::new("state x\ninput u, w\ndx ~ <u, w>\n", table(rows));
    Scenario::words(case, move |case, reason| {
        let seconds: f64 = reason.advice().split(' ').next().unwrap().parse().unwrap();
        case.recorded(vec![table(rows + (seconds / step) as usize)])
    })
}

/// An oscillation on a spring of this stiffness.
fn sprung(stiffness: f64, seed: u64) -> String {
    let rate = move |_: f64, z: &[f64; 2]| [z[1], -stiffness * z[0] - 0.2 * z[1]];
    let [x, _] = motion(rate, [1.0, 0.0], 0.05, 200);
    record(0.05, &[("x", &read(&x, 0.01, seed))])
}

pub fn run_not_followed() -> Scenario {
    let bad: Vec<f64> = (0..200)
        .map(|k| f64::from(i32::from(k / 17 % 2 == 0)) + 0.3 * (f64::from(k) * 0.9).sin())
        .collect();
    let bad = record(0.05, &[("x", &read(&bad, 0.01, 3))]);
    let case = Case::new("state x : order 2\nddx ~ poly(x, dx; 2)\n", String::new());
    let case = case.recorded(vec![sprung(4.0, 1), bad, sprung(4.0, 2)]);
    Scenario::words(case, |case, _| {
        case.recorded(vec![case.tables[0].clone(), case.tables[2].clone()])
    })
}

pub fn runs_differ() -> Scenario {
    let case = Case::new("state x : order 2\nddx ~ poly(x, dx; 2)\n", String::new());
    Scenario::change(case.recorded(vec![sprung(4.0, 1), sprung(4.4, 2)]))
}

/// Saturating friction, with or without speeds at which it saturates.
fn slowed(start: f64) -> String {
    let rate = |_: f64, z: &[f64; 1]| [-2.4 * (z[0] / 0.8).tanh()];
    let [x] = motion(rate, [start], 0.02, 200);
    record(0.02, &[("x", &read(&x, 0.01 * start, 3))])
}

pub fn uncertain_constant() -> Scenario {
    let model = "unknown k in 0.05..50\nstate x\ndx ~ <tanh(x/k)>\n";
    let case = Case::new(model, slowed(0.1));
    Scenario::words(case, |case, _| case.recorded(vec![slowed(3.0)]))
}

pub fn constant_range() -> Scenario {
    let model = "unknown k in 2..20\nstate x\ndx ~ <tanh(x/k)>\n";
    let case = Case::new(model, slowed(3.0));
    Scenario::words(case, |case, reason| {
        assert!(
            reason.advice().contains("unknown k in 0.2..20"),
            "{reason:?}"
        );
        case.rewritten("2..20", "0.2..20")
    })
}

/// A command that acts through a lag.
pub fn missing_state() -> Scenario {
    let model = "state x\ninput u : hold\ndx ~ <1, x, x^2, x^3, x^4, u>\n";
    Scenario::change(Case::new(model, crate::hidden_states::lagged(false, 8)))
}

pub fn unidentifiable() -> Scenario {
    let step = 0.05;
    // The level changes between samples, so that it is constant over each of them.
    let level = |t: f64| {
        if ((t / 2.5 + 0.01).floor() as i64) % 2 == 0 {
            1.0
        } else {
            -0.5
        }
    };
    let rate = move |t: f64, z: &[f64; 2]| {
        [
            z[1] - 0.5 * z[0] - 0.4 * z[0] * z[0],
            (level(t) - z[1]) / 2.0,
        ]
    };
    let [x, _] = motion(rate, [0.2, 0.0], step, 600);
    let u: Vec<f64> = (0..600).map(|k| level(f64::from(k) * step)).collect();
    let data = record(step, &[("x", &read(&x, 0.01, 7)), ("u", &u)]);
    let model = "unknown k in 0.1..10\nunknown tau in 0.1..50\nstate x\nstate f : hidden\ninput u : hold\n\
                 df = (k*u - f)/tau\ndx ~ <x, x^2, f, abs(u)>\n";
    // Of laws with candidates that switch nothing is said before the search.
    Scenario::words(Case::new(model, data), |case, _| {
        case.rewritten("unknown k in 0.1..10", "let k = 1")
    })
}
