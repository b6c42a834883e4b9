//! A self-activating gene: the rate of its protein saturates with a power of the protein's own concentration. The protein is diluted, and added in steps.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |&[x]: &[f64; 1], u: f64| {
        let bound = x.powf(2.6);
        [0.1 + 2.0 * bound / (0.9_f64.powf(2.6) + bound) - 1.2 * x + u]
    };
    let times = grid(800, 0.05);
    let added: Vec<f64> = Random::new(61)
        .square(times.len(), (20, 80), 0.4)
        .iter()
        .map(|s| decimals(s.abs(), 2))
        .collect();
    let mut table = Table::new(&["t", "x", "u"]);
    for ((t, [x]), u) in times
        .iter()
        .zip(held(&f, &times, [0.05], &added))
        .zip(&added)
    {
        table.push(&[*t, x, *u]);
    }
    vec![("gene.csv", table)]
}
