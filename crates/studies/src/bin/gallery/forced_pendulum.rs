//! A pendulum driven by an unmeasured torque of known frequency. The instrument adds a crude speed (backward difference).

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::random::decimals;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |t: f64, &[angle, speed]: &[f64; 2]| {
        let torque = 2.4 * (1.2 * t).cos() - 1.0 * (1.2 * t).sin();
        [speed, -4.0 * angle.sin() - 0.3 * speed + torque]
    };
    let times = grid(1000, 0.04);
    let mut table = Table::new(&["t", "theta", "dtheta"]);
    let mut before = 2.0;
    for (t, [theta, _]) in times.iter().zip(free(&f, &times, [2.0, 0.0])) {
        table.push(&[*t, theta, decimals((theta - before) / 0.04, 2)]);
        before = theta;
    }
    vec![("forced_pendulum.csv", table)]
}
