//! A pendulum lifted by a fan. The fan's speed follows its voltage with a lag and is not measured. Noise of 2 mrad.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |&[theta, omega, speed]: &[f64; 3], u: f64| {
        [
            omega,
            -60.0 * theta.sin() - 0.9 * omega + 11.0 * speed * speed,
            (u - speed) / 0.08,
        ]
    };
    let times = grid(1500, 0.01);
    let mut random = Random::new(32);
    let voltage: Vec<f64> = random
        .square(times.len(), (40, 160), 1.0)
        .iter()
        .map(|s| decimals(1.0 + 0.6 * s, 2))
        .collect();
    let mut table = Table::new(&["t", "theta", "u"]);
    for ((t, [theta, _, _]), u) in times
        .iter()
        .zip(held(&f, &times, [0.0, 0.0, 0.4], &voltage))
        .zip(&voltage)
    {
        table.push(&[*t, decimals(theta + 0.002 * random.normal(), 5), *u]);
    }
    vec![("fan.csv", table)]
}
