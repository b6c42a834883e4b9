//! Laws driven by white noise: an Ornstein–Uhlenbeck process, a double well, a van der Pol oscillator. Every draw has its own path.
//!
//! In: nothing. Out: the cases. At level 0 their sensors are exact.

use super::case::{Case, Motion, Sensor};
use sidc_testing::integrate::grid;
use sidc_testing::random::Random;
use sidc_testing::stochastic::path;
use sidc_testing::table::Table;

const STEP: f64 = 0.05;

pub fn cases() -> Vec<Case> {
    let case = |name, model: &str, law, motion, size| Case {
        name,
        model: model.into(),
        laws: vec![law],
        motion: Motion::Drawn(motion),
        sensors: vec![Sensor::white("x", size)],
    };
    vec![
        case(
            "driven_relaxation",
            "state x : order 1\ndx ~ poly(x; 4)\n",
            ("dx", vec![("x", -1.0)]),
            relaxation,
            0.35,
        ),
        case(
            "driven_double_well",
            "state x : order 1\ndx ~ poly(x; 5)\n",
            ("dx", vec![("x", 1.0), ("x^3", -1.0)]),
            double_well,
            0.9,
        ),
        case(
            "driven_van_der_pol",
            "state x : order 2\nddx ~ poly(x, dx; 3)\n",
            ("ddx", vec![("x", -1.0), ("dx", 2.0), ("x^2*dx", -2.0)]),
            van_der_pol,
            1.4,
        ),
    ]
}

fn positions<const N: usize>(path: Vec<[f64; N]>) -> Vec<Table> {
    let mut table = Table::new(&["t", "x"]);
    for (t, x) in grid(path.len(), STEP).into_iter().zip(path) {
        table.push(&[t, x[0]]);
    }
    vec![table]
}

fn relaxation(random: &mut Random) -> Vec<Table> {
    positions(path(&|x| [-x[0]], [0.5], [0.2], (4001, STEP), random))
}

fn double_well(random: &mut Random) -> Vec<Table> {
    let law = |x: &[f64; 1]| [x[0] - x[0].powi(3)];
    positions(path(&law, [0.5], [0.2], (8001, STEP), random))
}

fn van_der_pol(random: &mut Random) -> Vec<Table> {
    let law = |x: &[f64; 2]| [x[1], 2.0 * (1.0 - x[0] * x[0]) * x[1] - x[0]];
    positions(path(&law, [0.0, 0.3], [1.0, 0.0], (2001, STEP), random))
}
