//! A slide pushed in one direction over a lubricated guide: its friction falls with speed before it rises. Speed with noise of 1 %.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |&[v]: &[f64; 1], u: f64| [2.0 * u - 1.0 - 2.5 * (-v / 0.3).exp() - 0.8 * v];
    let times = grid(1200, 0.01);
    let mut random = Random::new(65);
    let force: Vec<f64> = random
        .square(times.len(), (15, 60), 1.0)
        .iter()
        .map(|s| decimals(1.4 + 0.9 * s, 2))
        .collect();
    let mut table = Table::new(&["t", "v", "u"]);
    for ((t, [v]), u) in times
        .iter()
        .zip(held(&f, &times, [0.5], &force))
        .zip(&force)
    {
        table.push(&[*t, decimals(v + 0.005 * random.normal(), 5), *u]);
    }
    vec![("stribeck.csv", table)]
}
