//! A motor with unmeasured current, which follows the voltage through the inductance of the winding. Noise of 0.5 rad/s.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |&[omega, current]: &[f64; 2], u: f64| {
        [
            250.0 * current - 2.0 * omega,
            (u - 1.2 * current - 0.05 * omega) / 0.008,
        ]
    };
    let times = grid(1500, 0.002);
    let mut random = Random::new(33);
    let voltage: Vec<f64> = (random.square(times.len(), (15, 60), 12.0).iter())
        .map(|u| decimals(*u, 1))
        .collect();
    let mut table = Table::new(&["t", "omega", "u"]);
    let states = held(&f, &times, [0.0, 0.0], &voltage);
    for ((t, [omega, _]), u) in times.iter().zip(states).zip(&voltage) {
        table.push(&[*t, decimals(omega + 0.5 * random.normal(), 2), *u]);
    }
    vec![("motor_current.csv", table)]
}
