//! A driven Duffing oscillator (two wells). The drive is a sum of sines, sampled in the table.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

fn drive(t: f64) -> f64 {
    0.5 * (1.2 * t).cos() + 0.4 * (0.7 * t).sin() + 0.3 * (2.3 * t).sin()
}

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |t: f64, &[x, v]: &[f64; 2]| [v, drive(t) - 0.2 * v + x - x * x * x];
    let times = grid(1000, 0.05);
    let mut table = Table::new(&["t", "x", "u"]);
    for (t, [x, _]) in times.iter().zip(free(&f, &times, [1.0, 0.0])) {
        table.push(&[*t, x, drive(*t)]);
    }
    vec![("duffing.csv", table)]
}
