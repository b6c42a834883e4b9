//! A ball on a springy floor, dropped three times. Height with noise.

use sidc_testing::integrate::grid;
use sidc_testing::random::{Random, decimals};
use sidc_testing::switched::Switched;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let ball = Switched {
        rates: Box::new(|_, [y, v], side| {
            [*v, -9.81 - 0.5 * (1.0 + side) * (4000.0 * y + 6.0 * v)]
        }),
        guard: Box::new(|_, [y, _]| -y),
        step: 2e-4,
    };
    let times = grid(500, 0.004);
    let mut random = Random::new(75);
    let mut table = Table::new(&["run", "t", "y"]);
    for (run, start) in [(1.0, [0.5, 0.0]), (2.0, [0.2, 1.5]), (3.0, [0.9, -0.5])] {
        for (t, [y, _]) in times.iter().zip(ball.run(&times, start)) {
            table.push(&[
                run,
                decimals(*t, 3),
                decimals(y + 0.0005 * random.normal(), 6),
            ]);
        }
    }
    vec![("bouncing_ball.csv", table)]
}
