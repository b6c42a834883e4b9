//! Two carts joined by a spring and a damper, each with an accelerometer; the first accelerometer is noisy.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

/// Standard deviations of the accelerometers, m/s².
const NOISE: [f64; 2] = [0.6, 0.05];

pub fn tables() -> Vec<(&'static str, Table)> {
    // m1 = 1 kg, m2 = 0.5 kg
    let link = |x: &[f64; 4]| 12.0 * (x[2] - x[0]) + 0.2 * (x[3] - x[1]);
    let f = |x: &[f64; 4], u: f64| {
        let first = -20.0 * x[0] - 0.3 * x[1] + link(x) + u;
        [x[1], first, x[3], -2.0 * link(x)]
    };
    let times = grid(400, 0.02);
    let mut random = Random::new(71);
    let push = random.square(times.len(), (15, 80), 10.0);
    let names = ["t", "x1", "dx1", "ddx1", "x2", "dx2", "ddx2", "u"];
    let mut table = Table::new(&names);
    let states = held(&f, &times, [0.3, 0.0, -0.3, 0.0], &push);
    for ((t, x), &u) in times.iter().zip(states).zip(&push) {
        let rate = f(&x, u);
        let mut read = |k: usize| decimals(rate[2 * k + 1] + NOISE[k] * random.normal(), 3);
        let places = |v: f64| decimals(v, 9);
        let (first, second) = (read(0), read(1));
        table.push(&[
            *t,
            places(x[0]),
            places(x[1]),
            first,
            places(x[2]),
            places(x[3]),
            second,
            u,
        ]);
    }
    vec![("two_carts.csv", table)]
}
