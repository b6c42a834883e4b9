//! A block on a belt, held by a spring: dry friction that falls with the speed of sliding. Positions with noise of 0.02 mm.

use sidc_testing::integrate::grid;
use sidc_testing::plants::switching::Switched;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let system = Switched {
        rates: |&[x, v]: &[f64; 2], belt: f64, side: f64| {
            let friction = 1.5 + 1.2 * (-(v - belt).abs() / 0.15).exp();
            [v, -25.0 * x - 0.4 * v - side * friction]
        },
        guard: |&[_, v]: &[f64; 2], belt: f64| v - belt,
    };
    let times = grid(1500, 0.01);
    let mut random = Random::new(71);
    let belt: Vec<f64> = random
        .square(times.len(), (60, 200), 1.0)
        .iter()
        .map(|s| decimals(0.2 + 0.15 * s, 2))
        .collect();
    let states = system.held(&times, [0.0, 0.0], &belt);
    let mut table = Table::new(&["t", "x", "V"]);
    for ((t, [x, _]), belt) in times.iter().zip(states).zip(&belt) {
        table.push(&[*t, decimals(x + 2e-5 * random.normal(), 6), *belt]);
    }
    vec![("stick_slip.csv", table)]
}
