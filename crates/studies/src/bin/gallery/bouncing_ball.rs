//! A ball dropped on a soft floor, three times. Heights with noise of 0.2 mm.

use sidc_testing::integrate::grid;
use sidc_testing::plants::switching::Switched;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let system = Switched {
        rates: |&[y, v]: &[f64; 2], _: f64, side: f64| {
            let floor = 0.5 * (1.0 + side) * (-3000.0 * y - 20.0 * v);
            [v, -9.81 + floor]
        },
        guard: |&[y, _]: &[f64; 2], _: f64| -y,
    };
    let times = grid(400, 0.005);
    let mut random = Random::new(75);
    let mut table = Table::new(&["run", "t", "y"]);
    for (run, start) in [0.5, 0.3, 0.8].into_iter().enumerate() {
        let states = system.held(&times, [start, 0.0], &vec![0.0; times.len()]);
        for (t, [y, _]) in times.iter().zip(states) {
            table.push(&[run as f64, *t, decimals(y + 0.0002 * random.normal(), 5)]);
        }
    }
    vec![("bouncing_ball.csv", table)]
}
