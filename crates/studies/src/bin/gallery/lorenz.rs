//! The Lorenz system: chaos in three states.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f =
        |_: f64, &[x, y, z]: &[f64; 3]| [10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z];
    let times = grid(1000, 0.01);
    let mut table = Table::new(&["t", "x", "y", "z"]);
    for (t, [x, y, z]) in times.iter().zip(free(&f, &times, [-8.0, 7.0, 27.0])) {
        table.push(&[*t, x, y, z]);
    }
    vec![("lorenz.csv", table)]
}
