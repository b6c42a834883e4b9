//! A pendulum in a dry bearing, let go three times: it comes to rest beside the vertical. Angle with noise.

use sidc_testing::integrate::grid;
use sidc_testing::random::{Random, decimals};
use sidc_testing::switched::Switched;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let pendulum = Switched {
        rates: Box::new(|_, [theta, v], side| [*v, -20.0 * theta.sin() - 0.1 * v - 1.5 * side]),
        guard: Box::new(|_, [_, v]| *v),
        step: 1e-3,
    };
    let times = grid(400, 0.02);
    let mut random = Random::new(73);
    let mut table = Table::new(&["run", "t", "theta"]);
    for (run, start) in [(1.0, 2.6), (2.0, -1.4), (3.0, 0.9)] {
        for (t, [theta, _]) in times.iter().zip(pendulum.run(&times, [start, 0.0])) {
            table.push(&[run, *t, decimals(theta + 0.002 * random.normal(), 5)]);
        }
    }
    vec![("dry_bearing.csv", table)]
}
