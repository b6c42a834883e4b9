//! Attacks with a damped pendulum, a random input and random constants.
//!
//! In: a kind of attack, a seed, a level of noise. Out: a case.

use super::{Attack, Case, Law, runge_kutta_step};
use crate::integrate::{grid, integrate};
use crate::pendulum_regression::Random;
use crate::table::Table;

const ROWS: usize = 600;
const STEP: f64 = 0.03;
/// Samples for which a random input is held.
const HOLD: usize = 20;

/// A damped pendulum with a random input and random constants; `noise` is relative to the spread of each column.
pub(super) fn case(attack: Attack, seed: u64, noise: f64) -> Case {
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
            Attack::CoarseSolver => coarsely(&rate, *t, STEP, z),
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
        runs: vec![Table {
            rows,
            digits: None,
            ..Table::new(names)
        }],
        laws: vec![Law {
            target: "ddx",
            terms: ["dx", "u", "sin(x)"].map(String::from).to_vec(),
            offered: attack.has_law(),
        }],
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
        Attack::RandomSystem | Attack::OmittedTerm => unreachable!("made by another module"),
    };
    let mut text = format!("state x : order 2\n{states}input u : {input}\nddx ~ {library}\n");
    if attack == Attack::SecondSensor {
        text.push_str("dw ~ poly(x, w, u; 3) + <sin x>\n");
    }
    text
}

/// Four steps of the classical Runge-Kutta method.
fn coarsely(
    rate: &impl Fn(f64, &[f64; 2]) -> [f64; 2],
    from: f64,
    step: f64,
    start: [f64; 2],
) -> [f64; 2] {
    let h = step / 4.0;
    (0..4).fold(start, |z, i| {
        runge_kutta_step(rate, from + f64::from(i) * h, h, &z)
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
