//! A mass on a belt, held by a spring: it rides along until the spring pulls it off, slides back, and is caught again. Position with noise.

use sidc_testing::integrate::grid;
use sidc_testing::random::{Random, decimals};
use sidc_testing::switched::Switched;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let belt = Switched {
        rates: Box::new(|_, [x, v], side| [*v, -x - side + 0.15 * (v - 0.3)]),
        guard: Box::new(|_, [_, v]| v - 0.3),
        step: 1e-3,
    };
    let times = grid(1500, 0.04);
    let mut random = Random::new(71);
    let mut table = Table::new(&["t", "x"]);
    for (t, [x, _]) in times.iter().zip(belt.run(&times, [0.2, 0.0])) {
        table.push(&[*t, decimals(x + 0.002 * random.normal(), 5)]);
    }
    vec![("stick_slip.csv", table)]
}
