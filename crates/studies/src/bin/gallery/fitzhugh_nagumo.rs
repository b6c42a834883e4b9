//! The FitzHugh–Nagumo model of a nerve under a stepwise stimulus, with measurement noise.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |&[v, w]: &[f64; 2], stimulus: f64| {
        [
            v - v * v * v / 3.0 - w + stimulus,
            0.08 * (v + 0.7 - 0.8 * w),
        ]
    };
    let times = grid(1200, 0.2);
    let mut random = Random::new(51);
    let stimulus: Vec<f64> = random
        .square(times.len(), (60, 200), 0.6)
        .iter()
        .map(|s| decimals(s + 0.5, 2))
        .collect();
    let mut table = Table::new(&["t", "v", "w", "I"]);
    let states = held(&f, &times, [-1.0, -0.5], &stimulus);
    for ((t, [v, w]), s) in times.iter().zip(states).zip(&stimulus) {
        let noisy =
            |x: f64, sigma: f64, random: &mut Random| decimals(x + sigma * random.normal(), 5);
        table.push(&[
            *t,
            noisy(v, 0.01, &mut random),
            noisy(w, 0.005, &mut random),
            *s,
        ]);
    }
    vec![("fitzhugh_nagumo.csv", table)]
}
