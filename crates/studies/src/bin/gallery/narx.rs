//! A sampled process with a nonlinear, delayed response to a valve: y(k+1) depends on y and u now and one sample ago.

use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let mut random = Random::new(21);
    let mut table = Table::new(&["y", "u"]);
    table.digits = None;
    let (mut y, mut y1, mut u1) = (0.0, 0.0, 0.0);
    for _ in 0..300 {
        let u = decimals(random.uniform(-1.0, 1.0), 3);
        table.push(&[y, u]);
        let next = 0.6 * y - 0.2 * y1 + 0.5 * u + 0.3 * u1 - 0.1 * y * y;
        (y1, u1, y) = (y, u, next);
    }
    vec![("narx.csv", table)]
}
