//! Two carts joined by a hardening spring and a damper. The first is tied to the wall and pushed.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::Random;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    // m1 = 1 kg, m2 = 0.5 kg
    let f = |&[x1, v1, x2, v2]: &[f64; 4], u: f64| {
        let stretch = x2 - x1;
        let link = 12.0 * stretch + 40.0 * stretch.powi(3) + 0.2 * (v2 - v1);
        [v1, -20.0 * x1 - 0.3 * v1 + link + u, v2, -link / 0.5]
    };
    let times = grid(1000, 0.02);
    let push = Random::new(31).square(times.len(), (15, 80), 10.0);
    let mut table = Table::new(&["t", "x1", "x2", "u"]);
    let states = held(&f, &times, [0.3, 0.0, -0.3, 0.0], &push);
    for ((t, [x1, _, x2, _]), u) in times.iter().zip(states).zip(&push) {
        table.push(&[*t, x1, x2, *u]);
    }
    vec![("two_mass.csv", table)]
}
