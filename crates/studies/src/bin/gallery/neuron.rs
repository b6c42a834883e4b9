//! A neuron that charges towards its input, fires and begins anew. Voltages with noise of 0.1 mV.

use sidc_testing::integrate::grid;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let mut random = Random::new(78);
    let mut table = Table::new(&["t", "v", "I"]);
    let (tau, top, low) = (12.0, -50.0, -68.0);
    let levels = [22.0, 35.0, 10.0, 28.0, 17.0, 40.0, 25.0, 19.0];
    let times = grid(800, 0.5);
    let mut v = -65.0;
    for (k, t) in times.iter().enumerate() {
        let input = levels[k / 100];
        table.push(&[*t, decimals(v + 0.1 * random.normal(), 3), input]);
        // One sample on: dv = (−65 − v + I)/12, from jump to jump.
        let (rest, mut left) = (-65.0 + input, 0.5);
        let fires = |v: f64| match rest > top {
            true => tau * f64::ln((rest - v) / (rest - top)),
            false => f64::INFINITY,
        };
        while fires(v) <= left {
            (v, left) = (low, left - fires(v));
        }
        v = rest + (v - rest) * f64::exp(-left / tau);
    }
    vec![("neuron.csv", table)]
}
