//! An enzyme with a competitive inhibitor that is itself degraded; six runs in one file.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |_: f64, &[s, i]: &[f64; 2]| [0.3 - 1.5 * s / (0.5 * (1.0 + i / 0.2) + s), -0.4 * i];
    let times = grid(120, 0.05);
    let mut table = Table::new(&["run", "t", "s", "i"]);
    let starts = [
        [0.1, 1.0],
        [0.5, 0.0],
        [1.0, 0.3],
        [2.0, 2.0],
        [4.0, 0.6],
        [6.0, 0.1],
    ];
    for (run, start) in starts.into_iter().enumerate() {
        for (t, [s, i]) in times.iter().zip(free(&f, &times, start)) {
            table.push(&[run as f64 + 1.0, *t, s, i]);
        }
    }
    vec![("inhibition.csv", table)]
}
