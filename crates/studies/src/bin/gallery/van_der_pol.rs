//! The van der Pol oscillator, started inside and outside its limit cycle; only the position is recorded.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |_: f64, &[x, v]: &[f64; 2]| [v, 1.5 * (1.0 - x * x) * v - x];
    let times = grid(400, 0.05);
    let mut table = Table::new(&["run", "t", "x"]);
    for (run, start) in [[0.2, 0.0], [-2.5, 3.0]].into_iter().enumerate() {
        for (t, [x, _]) in times.iter().zip(free(&f, &times, start)) {
            table.push(&[run as f64 + 1.0, *t, x]);
        }
    }
    vec![("van_der_pol.csv", table)]
}
