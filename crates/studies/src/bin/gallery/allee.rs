//! A population with an Allee effect: it grows above a threshold and dies out below. Seven records of counts with noise of 1 %.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |_: f64, &[x]: &[f64; 1]| [2.0 * x * x / (0.8 + x) - 0.4 * x - 0.3 * x * x];
    let times = grid(150, 0.1);
    let mut random = Random::new(66);
    let mut table = Table::new(&["run", "t", "x"]);
    let starts = [0.1, 0.14, 0.17, 0.4, 0.7, 6.0, 12.0];
    for (run, start) in starts.into_iter().enumerate() {
        for (t, [x]) in times.iter().zip(free(&f, &times, [start])) {
            let read = decimals(x * (1.0 + 0.01 * random.normal()), 5);
            table.push(&[run as f64 + 1.0, *t, read]);
        }
    }
    vec![("allee.csv", table)]
}
