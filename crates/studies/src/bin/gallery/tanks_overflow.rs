//! Two tanks in cascade. The upper one, with unmeasured level, overflows at 9, and two fifths of the overflow run into the lower one. Noise of 0.02.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |&[upper, lower]: &[f64; 2], u: f64| {
        let through = 0.06 * upper.max(0.0).sqrt();
        let over = 0.5 * (upper - 9.0).max(0.0);
        [
            0.12 * u - through - over,
            through + 0.4 * over - 0.05 * lower.max(0.0).sqrt(),
        ]
    };
    let times = grid(900, 4.0);
    let mut random = Random::new(34);
    let pump: Vec<f64> = (random.square(times.len(), (15, 60), 1.0).iter())
        .map(|s| decimals((1.1 + s).max(0.05), 2))
        .collect();
    let mut table = Table::new(&["t", "y", "u"]);
    let states = held(&f, &times, [3.0, 3.0], &pump);
    for ((t, [_, lower]), u) in times.iter().zip(states).zip(&pump) {
        table.push(&[*t, decimals(lower + 0.02 * random.normal(), 3), *u]);
    }
    vec![("tanks_overflow.csv", table)]
}
