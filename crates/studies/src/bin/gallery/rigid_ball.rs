//! A ball that leaves a rigid floor with a part of its speed. Heights with noise of 1 mm.

use sidc_testing::integrate::grid;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

/// Height and speed some time after the beginning of a flight: ddy = −g − c dy.
fn flown([y, v]: [f64; 2], time: f64) -> [f64; 2] {
    let (g, c) = (9.81, 0.15);
    let (last, decay) = (-g / c, f64::exp(-c * time));
    [
        y + last * time + (v - last) / c * (1.0 - decay),
        last + (v - last) * decay,
    ]
}

/// How long a flight takes that begins at or above the floor.
fn flight(start: [f64; 2]) -> f64 {
    let (mut low, mut high) = (1e-6, 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match flown(start, middle)[0] > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    high
}

pub fn tables() -> Vec<(&'static str, Table)> {
    let mut random = Random::new(76);
    let mut table = Table::new(&["t", "y"]);
    let (mut from, mut start) = (0.0, [1.2, 0.5]);
    for t in grid(300, 0.01) {
        while t - from >= flight(start) {
            let time = flight(start);
            from += time;
            start = [0.0, -0.8 * flown(start, time)[1]];
        }
        let [y, _] = flown(start, t - from);
        table.push(&[t, decimals(y + 0.001 * random.normal(), 4)]);
    }
    vec![("rigid_ball.csv", table)]
}
