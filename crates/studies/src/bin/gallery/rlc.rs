//! A series RLC circuit on a switched source. The scope's file has no time column and gives the current in mA.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::Random;
use sidc_testing::table::Table;

/// In ohm, henry and farad.
const R: f64 = 2.0;
const L: f64 = 0.01;
const C: f64 = 470e-6;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |&[i, v]: &[f64; 2], u: f64| [(u - R * i - v) / L, i / C];
    let times = grid(600, 1e-4);
    let source = Random::new(11).square(times.len(), (8, 50), 10.0);
    let mut table = Table::new(&["i [mA]", "u_C [V]", "u [V]", "u_L [V]"]);
    for ([i, v], u) in held(&f, &times, [0.0, 0.0], &source)
        .into_iter()
        .zip(source)
    {
        table.push(&[1e3 * i, v, u, u - R * i - v]);
    }
    vec![("rlc.csv", table)]
}
