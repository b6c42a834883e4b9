//! A pendulum in a dry bearing, let go three times until it rests. Angles with noise of 0.5 mrad.

use sidc_testing::integrate::grid;
use sidc_testing::plants::switching::Switched;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let system = Switched {
        rates: |&[theta, v]: &[f64; 2], _: f64, side: f64| {
            [v, -30.0 * theta.sin() - 0.15 * v - 1.1 * side]
        },
        guard: |&[_, v]: &[f64; 2], _: f64| v,
    };
    let times = grid(500, 0.02);
    let mut random = Random::new(73);
    let mut table = Table::new(&["run", "t", "theta"]);
    for (run, start) in [2.4, -1.2, 0.5].into_iter().enumerate() {
        let states = system.held(&times, [start, 0.0], &vec![0.0; times.len()]);
        for (t, [theta, _]) in times.iter().zip(states) {
            table.push(&[
                run as f64,
                *t,
                decimals(theta + 0.0005 * random.normal(), 5),
            ]);
        }
    }
    vec![("dry_pendulum.csv", table)]
}
