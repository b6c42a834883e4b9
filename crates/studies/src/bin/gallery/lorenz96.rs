//! The Lorenz 96 system with five sites on a circle.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |_: f64, x: &[f64; 5]| {
        std::array::from_fn(|i| (x[(i + 1) % 5] - x[(i + 3) % 5]) * x[(i + 4) % 5] - x[i] + 8.0)
    };
    let times = grid(600, 0.01);
    let mut table = Table::new(&["t", "x1", "x2", "x3", "x4", "x5"]);
    for (t, x) in times
        .iter()
        .zip(free(&f, &times, [1.0, 5.0, -2.0, 3.0, 0.5]))
    {
        table.push(&[*t, x[0], x[1], x[2], x[3], x[4]]);
    }
    vec![("lorenz96.csv", table)]
}
