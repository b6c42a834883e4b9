//! The Brusselator: a chemical clock.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |_: f64, &[x, y]: &[f64; 2]| [1.0 - 4.0 * x + x * x * y, 3.0 * x - x * x * y];
    let times = grid(600, 0.04);
    let mut table = Table::new(&["t", "x", "y"]);
    for (t, [x, y]) in times.iter().zip(free(&f, &times, [0.6, 1.0])) {
        table.push(&[*t, x, y]);
    }
    vec![("brusselator.csv", table)]
}
