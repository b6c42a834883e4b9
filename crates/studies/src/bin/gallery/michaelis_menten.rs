//! Michaelis–Menten kinetics with a constant inflow of substrate; five runs in one file.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |_: f64, &[x]: &[f64; 1]| [0.6 - 1.5 * x / (0.3 + x)];
    let times = grid(100, 0.04);
    let mut table = Table::new(&["run", "t", "x"]);
    for (run, start) in [0.05, 0.4, 1.0, 3.0, 6.0].into_iter().enumerate() {
        for (t, [x]) in times.iter().zip(free(&f, &times, [start])) {
            table.push(&[run as f64 + 1.0, *t, x]);
        }
    }
    vec![("michaelis_menten.csv", table)]
}
