//! A room with a radiator that a thermostat switches at 21 °C, while it grows colder outside. Temperatures with noise.

use sidc_testing::integrate::grid;
use sidc_testing::random::{Random, decimals};
use sidc_testing::switched::Switched;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let outside = |t: f64| 8.0 + 6.0 * (0.02 * t).sin();
    let times = grid(1500, 0.2);
    let sampled: Vec<f64> = times.iter().map(|t| decimals(outside(*t), 4)).collect();
    let linear = sampled.clone();
    let room = Switched {
        rates: Box::new(move |t, [room, radiator], side| {
            let k = ((t / 0.2) as usize).min(linear.len() - 2);
            let part = t / 0.2 - k as f64;
            let cold = linear[k] + part * (linear[k + 1] - linear[k]);
            [
                0.1 * (radiator - room) - 0.08 * (room - cold),
                -0.3 * (radiator - room) + 5.0 * (1.0 + side),
            ]
        }),
        guard: Box::new(|_, [room, _]| 21.0 - room),
        step: 0.01,
    };
    let mut random = Random::new(74);
    let mut table = Table::new(&["t", "T", "H", "To"]);
    let rows = times
        .iter()
        .zip(room.run(&times, [15.0, 20.0]))
        .zip(&sampled);
    for ((t, [room, radiator]), cold) in rows {
        let mut read = |x: f64, noise: f64| decimals(x + noise * random.normal(), 3);
        table.push(&[
            decimals(*t, 1),
            read(room, 0.01),
            read(radiator, 0.05),
            *cold,
        ]);
    }
    vec![("thermostat.csv", table)]
}
