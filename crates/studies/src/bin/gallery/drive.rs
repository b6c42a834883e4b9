//! A positioning drive with viscous and dry friction, pushed to and fro so that it often rests. Positions with noise of 0.1 mm.

use sidc_testing::integrate::grid;
use sidc_testing::plants::switching::Switched;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let system = Switched {
        rates: |&[_, v]: &[f64; 2], u: f64, side: f64| [v, 0.05 + u / 95.0 - 0.9 * v - 0.21 * side],
        guard: |&[_, v]: &[f64; 2], _: f64| v,
    };
    let times = grid(1500, 0.01);
    let mut random = Random::new(72);
    let force: Vec<f64> = random
        .square(times.len(), (20, 70), 1.0)
        .iter()
        .map(|s| decimals(40.0 * s, 1))
        .collect();
    let states = system.held(&times, [0.0, 0.0], &force);
    let mut table = Table::new(&["t", "q", "u"]);
    for ((t, [q, _]), u) in times.iter().zip(states).zip(&force) {
        table.push(&[*t, decimals(q + 1e-4 * random.normal(), 6), *u]);
    }
    vec![("drive.csv", table)]
}
