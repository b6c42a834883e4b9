//! A coil with an iron core that saturates, on a source that steps: L(i) = 0.1 + 0.5/(1 + (i/1.5)²) H, R = 2 Ω.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |&[i]: &[f64; 1], u: f64| {
        let inductance = 0.1 + 0.5 / (1.0 + (i / 1.5_f64).powi(2));
        [(u - 2.0 * i) / inductance]
    };
    let times = grid(800, 0.005);
    let source: Vec<f64> = Random::new(64)
        .square(times.len(), (20, 80), 9.0)
        .iter()
        .map(|s| decimals(*s, 1))
        .collect();
    let mut table = Table::new(&["t", "i", "u"]);
    for ((t, [i]), u) in times
        .iter()
        .zip(held(&f, &times, [0.0], &source))
        .zip(&source)
    {
        table.push(&[*t, i, *u]);
    }
    vec![("coil.csv", table)]
}
