//! The Lorenz system with two states measured, with noise of 1 % of their spread.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f =
        |_: f64, &[x, y, z]: &[f64; 3]| [10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z];
    let times = grid(1500, 0.01);
    let mut random = Random::new(33);
    let mut table = Table::new(&["t", "x", "y"]);
    for (t, [x, y, _]) in times.iter().zip(free(&f, &times, [-8.0, 7.0, 27.0])) {
        let (x, y) = (x + 0.08 * random.normal(), y + 0.09 * random.normal());
        table.push(&[*t, decimals(x, 4), decimals(y, 4)]);
    }
    vec![("lorenz_hidden.csv", table)]
}
