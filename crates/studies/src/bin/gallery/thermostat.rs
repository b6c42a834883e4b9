//! A room with a thermostat that nobody set down. Temperatures with noise of 0.05 K.

use sidc_testing::integrate::grid;
use sidc_testing::plants::switching::Switched;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let system = Switched {
        rates: |&[room]: &[f64; 1], outside: f64, side: f64| {
            [-0.2 * (room - outside) + 1.8 * (1.0 + side)]
        },
        guard: |&[room]: &[f64; 1], _: f64| 20.5 - room,
    };
    let times = grid(1000, 0.25);
    let mut random = Random::new(74);
    let outside: Vec<f64> = random
        .square(times.len(), (20, 80), 1.0)
        .iter()
        .zip(&times)
        .map(|(s, t)| decimals(9.0 + 9.0 * (t * 0.09).sin() + 7.0 * s, 1))
        .collect();
    let states = system.held(&times, [14.0], &outside);
    let mut table = Table::new(&["t", "T", "Ta"]);
    for ((t, [room]), outside) in times.iter().zip(states).zip(&outside) {
        table.push(&[*t, decimals(room + 0.05 * random.normal(), 3), *outside]);
    }
    vec![("thermostat.csv", table)]
}
