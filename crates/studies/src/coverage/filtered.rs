//! Sensors with a filter, so that 0.5, 0.8 or 0.95 of every error remains at the next sample.
//!
//! In: nothing. Out: the cases: an oscillator, a pendulum with only the angle measured, predator and prey, a nerve cell.

use super::case::{Case, Law, Motion, Sensor, deviation};
use sidc_testing::integrate::{grid, integrate};
use sidc_testing::table::Table;

/// Names of the cases, by the correlation of errors between samples.
const MEMORIES: [(f64, [&str; 4]); 3] = [
    (
        0.5,
        [
            "filtered_50_oscillator",
            "filtered_50_pendulum",
            "filtered_50_populations",
            "filtered_50_nerve",
        ],
    ),
    (
        0.8,
        [
            "filtered_80_oscillator",
            "filtered_80_pendulum",
            "filtered_80_populations",
            "filtered_80_nerve",
        ],
    ),
    (
        0.95,
        [
            "filtered_95_oscillator",
            "filtered_95_pendulum",
            "filtered_95_populations",
            "filtered_95_nerve",
        ],
    ),
];

pub fn cases() -> Vec<Case> {
    let of = |(memory, names): (f64, [&'static str; 4])| {
        let [a, b, c, d] = names;
        [
            oscillator(a, memory),
            pendulum(b, memory),
            populations(c, memory),
            nerve(d, memory),
        ]
    };
    MEMORIES.into_iter().flat_map(of).collect()
}

/// A case whose first `read` states have sensors.
fn case<const N: usize>(
    (name, memory): (&'static str, f64),
    (model, laws): (&str, Vec<Law>),
    rates: impl Fn(&[f64; N]) -> [f64; N],
    (mut state, rows, step): ([f64; N], usize, f64),
    read: &[&'static str],
) -> Case {
    let names: Vec<&str> = ["t"].iter().chain(read).copied().collect();
    let mut table = Table::new(&names);
    for t in grid(rows, step) {
        let row: Vec<f64> = [t].into_iter().chain(state).take(names.len()).collect();
        table.push(&row);
        state = integrate(&|_: f64, z: &[f64; N]| rates(z), t, t + step, state);
    }
    let tables = vec![table];
    let sensor = |(i, column): (usize, &&'static str)| Sensor {
        column,
        size: deviation(&tables, i + 1),
        memory,
    };
    Case {
        name,
        model: model.into(),
        laws,
        sensors: read.iter().enumerate().map(sensor).collect(),
        motion: Motion::Fixed(tables),
    }
}

fn oscillator(name: &'static str, memory: f64) -> Case {
    case(
        (name, memory),
        (
            "state x, y\ndx, dy ~ poly(x, y; 3)\n",
            vec![
                ("dx", vec![("y", 1.0)]),
                ("dy", vec![("x", -1.0), ("y", 2.0), ("x^2*y", -2.0)]),
            ],
        ),
        |[x, y]| [*y, 2.0 * (1.0 - x * x) * y - x],
        ([1.0, 0.0], 401, 0.05),
        &["x", "y"],
    )
}

fn pendulum(name: &'static str, memory: f64) -> Case {
    case(
        (name, memory),
        (
            "state x : order 2\nddx ~ <1, x, dx, sin x, cos x, x^2, dx^2, x*dx, dx^3>\n",
            vec![("ddx", vec![("dx", -0.3), ("sin(x)", -9.8)])],
        ),
        |[x, v]| [*v, -9.8 * x.sin() - 0.3 * v],
        ([2.5, 0.0], 401, 0.025),
        &["x"],
    )
}

fn populations(name: &'static str, memory: f64) -> Case {
    case(
        (name, memory),
        (
            "state x, y\ndx, dy ~ poly(x, y; 2)\n",
            vec![
                ("dx", vec![("x", 1.1), ("x*y", -0.4)]),
                ("dy", vec![("y", -0.4), ("x*y", 0.1)]),
            ],
        ),
        |[x, y]| [1.1 * x - 0.4 * x * y, -0.4 * y + 0.1 * x * y],
        ([10.0, 5.0], 401, 0.075),
        &["x", "y"],
    )
}

fn nerve(name: &'static str, memory: f64) -> Case {
    case(
        (name, memory),
        (
            "state x, y\ndx, dy ~ poly(x, y; 3)\n",
            vec![
                (
                    "dx",
                    vec![("1", 0.5), ("x", 1.0), ("y", -1.0), ("x^3", -1.0 / 3.0)],
                ),
                ("dy", vec![("1", 0.056), ("x", 0.08), ("y", -0.064)]),
            ],
        ),
        |[x, y]| [x - x.powi(3) / 3.0 - y + 0.5, 0.08 * x + 0.056 - 0.064 * y],
        ([-1.0, 1.0], 601, 0.2),
        &["x", "y"],
    )
}
