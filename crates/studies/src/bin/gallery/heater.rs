//! A heated block. The heater between command and block has an unmeasured temperature. Noise of 0.05 K.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |&[block, heater]: &[f64; 2], q: f64| {
        [0.006 * heater - 0.009 * (block - 23.0), (q - heater) / 27.0]
    };
    let times = grid(900, 2.0);
    let mut random = Random::new(31);
    let command: Vec<f64> = random
        .square(times.len(), (30, 120), 1.0)
        .iter()
        .map(|s| decimals(50.0 + 40.0 * s, 1))
        .collect();
    let mut table = Table::new(&["t", "T", "Q"]);
    for ((t, [block, _]), q) in times
        .iter()
        .zip(held(&f, &times, [23.0, 0.0], &command))
        .zip(&command)
    {
        table.push(&[*t, decimals(block + 0.05 * random.normal(), 3), *q]);
    }
    vec![("heater.csv", table)]
}
