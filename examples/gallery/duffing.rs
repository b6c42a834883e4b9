//! A driven Duffing oscillator (two wells); the drive is a sum of sines, played back with linear interpolation.

use crate::response::linear;
use crate::simulate::integrate::grid;
use crate::simulate::random::decimals;
use crate::simulate::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |&[x, v]: &[f64; 2], u: f64| [v, u - 0.2 * v + x - x * x * x];
    let times = grid(1000, 0.05);
    let drive: Vec<f64> = times
        .iter()
        .map(|t| {
            decimals(
                0.5 * (1.2 * t).cos() + 0.4 * (0.7 * t).sin() + 0.3 * (2.3 * t).sin(),
                4,
            )
        })
        .collect();
    let mut table = Table::new(&["t", "x", "u"]);
    let states = linear(&f, &times, [1.0, 0.0], &drive);
    for ((t, [x, _]), u) in times.iter().zip(states).zip(&drive) {
        table.push(&[*t, x, *u]);
    }
    vec![("duffing.csv", table)]
}
