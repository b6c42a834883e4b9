//! A double pendulum that hangs from a cart, pushed by a held random force; positions, speeds and accelerations are measured.

use super::response::held;
use crate::integrate::grid;
use crate::random::Random;
use crate::table::Table;

const CART: f64 = 0.6;
const BOBS: [f64; 2] = [0.3, 0.2];
const RODS: [f64; 2] = [0.5, 0.4];
const GRAVITY: f64 = 9.8;
const TRACK_FRICTION: f64 = 0.05;
const JOINT_FRICTION: f64 = 0.01;

/// x, θ₁, θ₂ and their speeds.
type State = [f64; 6];

const NAMES: [&str; 11] = [
    "t", "x", "th1", "th2", "dx", "dth1", "dth2", "ddx", "ddth1", "ddth2", "F",
];

pub fn tables() -> Vec<(&'static str, Table)> {
    let (names, rows) = record(5, 600, 0.05, (2, 12));
    let mut table = Table::new(&names);
    table.digits = None;
    rows.iter().for_each(|row| table.push(row));
    vec![("double_pendulum.csv", table)]
}

/// Rows of every signal, `step` apart, under levels of force within ±8 N held for (fewest, most) samples.
pub fn record(
    seed: u64,
    rows: usize,
    step: f64,
    hold: (usize, usize),
) -> ([&'static str; 11], Vec<[f64; 11]>) {
    let f = |s: &State, force: f64| {
        let [a, b, c] = accelerations(s, force);
        [s[3], s[4], s[5], a, b, c]
    };
    let times = grid(rows, step);
    let force = Random::new(seed).square(times.len(), hold, 8.0);
    let states = held(&f, &times, [0.0; 6], &force);
    let row = |((t, s), u): ((&f64, State), &f64)| {
        let [a, b, c] = accelerations(&s, *u);
        [*t, s[0], s[1], s[2], s[3], s[4], s[5], a, b, c, *u]
    };
    (
        NAMES,
        times.iter().zip(states).zip(&force).map(row).collect(),
    )
}

/// Solves the three laws for (ẍ, θ̈₁, θ̈₂) by Cramer's rule.
fn accelerations(&[_, t1, t2, dx, d1, d2]: &State, force: f64) -> [f64; 3] {
    let ([m1, m2], [l1, l2]) = (BOBS, RODS);
    let (upper, lower) = ((m1 + m2) * l1, m2 * l2);
    let (sin, cos) = (t1 - t2).sin_cos();
    let mass = [
        [CART + m1 + m2, upper * t1.cos(), lower * t2.cos()],
        [upper * t1.cos(), upper * l1, lower * l1 * cos],
        [lower * t2.cos(), lower * l1 * cos, lower * l2],
    ];
    let right = [
        force - TRACK_FRICTION * dx + upper * d1 * d1 * t1.sin() + lower * d2 * d2 * t2.sin(),
        -JOINT_FRICTION * d1 - upper * GRAVITY * t1.sin() - lower * l1 * d2 * d2 * sin,
        -JOINT_FRICTION * d2 - lower * GRAVITY * t2.sin() + lower * l1 * d1 * d1 * sin,
    ];
    let whole = determinant(&mass);
    std::array::from_fn(|column| {
        let mut replaced = mass;
        for (row, r) in replaced.iter_mut().zip(right) {
            row[column] = r;
        }
        determinant(&replaced) / whole
    })
}

fn determinant([a, b, c]: &[[f64; 3]; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}
