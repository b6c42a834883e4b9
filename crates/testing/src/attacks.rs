//! Attacks on the verdict: random systems with data from which a wrong law may pass, or a right one be doubted.
//!
//! In: a kind of attack, a seed, a level of noise. Out: a model, a table, and the terms of the law where the library holds it. Every
//! number of a case follows from its seed.

use crate::integrate::{grid, integrate};
use crate::pendulum_regression::Random;
use crate::table::Table;

const ROWS: usize = 600;
const STEP: f64 = 0.03;
/// Samples for which a random input is held.
const HOLD: usize = 20;

/// What a case does to the verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attack {
    /// Nothing: the law is in the library.
    Honest,
    /// The sine of the law is not in the library.
    MissingTerm,
    /// The library holds the target in other words.
    Copy,
    /// A second sensor measures the rate.
    SecondSensor,
    /// The input is one sine, and only the steady motion is recorded.
    SteadySine,
    /// A small swing without noise, and powers in place of the sine.
    Series,
    /// The solver that made the data took few steps.
    CoarseSolver,
}

impl Attack {
    pub const ALL: [Attack; 7] = [
        Attack::Honest,
        Attack::MissingTerm,
        Attack::Copy,
        Attack::SecondSensor,
        Attack::SteadySine,
        Attack::Series,
        Attack::CoarseSolver,
    ];

    /// Whether the library holds the law. A steady motion need not tell it.
    pub fn has_law(self) -> bool {
        let without = [Attack::MissingTerm, Attack::SecondSensor, Attack::Series];
        !without.contains(&self)
    }
}

/// One case.
pub struct Case {
    pub model: String,
    /// Written with all digits, so that exact data stay exact.
    pub table: Table,
    /// The terms of ddx.
    pub law: Vec<&'static str>,
}

/// A damped pendulum with a random input and random constants; `noise` is relative to the spread of each column.
pub fn case(attack: Attack, seed: u64, noise: f64) -> Case {
    let mut random = Random::new(1000 + seed);
    let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
    let (k, d, gain) = (between(3.0, 9.0), between(0.15, 0.5), between(1.0, 3.0));
    let amplitude = match attack {
        Attack::Series => between(0.25, 0.6),
        _ => between(1.0, 1.6),
    };
    let frequency = between(1.2, 2.2);
    let levels: Vec<f64> = (0..=ROWS / HOLD).map(|_| between(-1.5, 1.5)).collect();
    let steady = attack == Attack::SteadySine;
    let lead = if steady { 4000 } else { 0 };
    let force = |t: f64, row: usize| match attack {
        Attack::SteadySine => (frequency * t).sin(),
        Attack::Series => 0.0,
        _ => levels[row / HOLD],
    };
    let times = grid(ROWS + lead, STEP);
    let mut z = [amplitude, 0.0];
    let mut rows = Vec::new();
    for (row, t) in times.iter().enumerate() {
        let u = force(*t, row.saturating_sub(lead));
        if row >= lead {
            rows.push(vec![t - times[lead], z[0], u, z[1]]);
        }
        let rate = |t: f64, z: &[f64; 2]| {
            let u = if steady { (frequency * t).sin() } else { u };
            [z[1], -k * z[0].sin() - d * z[1] + gain * u]
        };
        z = match attack {
            Attack::CoarseSolver => runge_kutta(&rate, *t, STEP, z),
            _ => integrate(&rate, *t, t + STEP, z),
        };
    }
    disturb(&mut rows, noise, &mut random);
    if attack != Attack::SecondSensor {
        rows.iter_mut().for_each(|row| row.truncate(3));
    }
    let names: &[&str] = match attack {
        Attack::SecondSensor => &["t", "x", "u", "w"],
        _ => &["t", "x", "u"],
    };
    Case {
        model: model(attack),
        table: Table {
            rows,
            digits: None,
            ..Table::new(names)
        },
        law: vec!["dx", "u", "sin(x)"],
    }
}

fn model(attack: Attack) -> String {
    let input = if attack == Attack::SteadySine {
        "linear"
    } else {
        "hold"
    };
    let (states, library) = match attack {
        Attack::Honest | Attack::CoarseSolver => ("", "poly(x, dx, u; 2) + <sin x, cos x>"),
        Attack::MissingTerm => ("", "poly(x, dx, u; 3)"),
        Attack::Copy => (
            "",
            "poly(x, dx, u; 2) + <sin x, cos x, max(ddx, -1e4), ddx*exp(x)*exp(-x)>",
        ),
        Attack::SecondSensor => ("state w\n", "poly(x, dx; 3) + dw*<1, x>"),
        Attack::SteadySine => ("", "poly(x, dx, u; 2) + <sin x, cos x>"),
        Attack::Series => ("", "poly(x, dx; 5)"),
    };
    let mut text = format!("state x : order 2\n{states}input u : {input}\nddx ~ {library}\n");
    if attack == Attack::SecondSensor {
        text.push_str("dw ~ poly(x, w, u; 3) + <sin x>\n");
    }
    text
}

/// Four steps of the classical Runge-Kutta method.
fn runge_kutta(
    rate: &dyn Fn(f64, &[f64; 2]) -> [f64; 2],
    from: f64,
    step: f64,
    start: [f64; 2],
) -> [f64; 2] {
    let h = step / 4.0;
    let moved = |z: &[f64; 2], k: &[f64; 2], by: f64| [z[0] + by * k[0], z[1] + by * k[1]];
    (0..4).fold(start, |z, i| {
        let t = from + f64::from(i) * h;
        let a = rate(t, &z);
        let b = rate(t + 0.5 * h, &moved(&z, &a, 0.5 * h));
        let c = rate(t + 0.5 * h, &moved(&z, &b, 0.5 * h));
        let d = rate(t + h, &moved(&z, &c, h));
        let mean = |i: usize| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0;
        moved(&z, &[mean(0), mean(1)], h)
    })
}

/// Adds noise to all columns but time and the input.
fn disturb(rows: &mut [Vec<f64>], noise: f64, random: &mut Random) {
    for column in [1, 3] {
        let count = rows.len() as f64;
        let mean = rows.iter().map(|r| r[column]).sum::<f64>() / count;
        let square = rows.iter().map(|r| (r[column] - mean).powi(2)).sum::<f64>() / count;
        let sigma = noise * square.sqrt();
        for row in rows.iter_mut() {
            row[column] += sigma * random.normal();
        }
    }
}

impl Case {
    /// The columns by name, time first.
    pub fn columns(&self) -> Vec<(&'static str, Vec<f64>)> {
        let names = self.table.names.iter().enumerate();
        let column = |i: usize| self.table.rows.iter().map(|r| r[i]).collect();
        names.map(|(i, name)| (*name, column(i))).collect()
    }
}
