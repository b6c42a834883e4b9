//! A diode in parallel with a capacitor of 1 µF, fed through 1 kΩ by a source that steps.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    // In mA, µF and ms.
    let f = |&[v]: &[f64; 1], u: f64| [u - v - 1e-6 * ((v / 0.05).exp() - 1.0)];
    let times = grid(800, 0.02);
    let source: Vec<f64> = Random::new(63)
        .square(times.len(), (15, 60), 2.5)
        .iter()
        .map(|s| decimals(*s, 2))
        .collect();
    let mut table = Table::new(&["t", "v", "u"]);
    for ((t, [v]), u) in times
        .iter()
        .zip(held(&f, &times, [0.1], &source))
        .zip(&source)
    {
        table.push(&[*t, v, *u]);
    }
    vec![("diode.csv", table)]
}
