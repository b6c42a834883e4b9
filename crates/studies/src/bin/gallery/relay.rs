//! A room whose heating goes off at one temperature and on at another. Temperatures with noise of 0.05 K.

use sidc_testing::integrate::grid;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let mut random = Random::new(77);
    let mut table = Table::new(&["t", "T", "on"]);
    // dT = 0.5 − 0.1 T + 3 on
    let (mut from, mut start, mut on) = (0.0, 18.0, 1.0);
    for t in grid(600, 0.1) {
        loop {
            let rest = 5.0 + 30.0 * on;
            let level = if on == 1.0 { 23.0 } else { 16.0 };
            let switches = from + 10.0 * f64::ln((start - rest) / (level - rest));
            if t < switches {
                let room = rest + (start - rest) * f64::exp(-0.1 * (t - from));
                let read = decimals(room + 0.05 * random.normal(), 3);
                table.push(&[t, read, on]);
                break;
            }
            (from, start, on) = (switches, level, 1.0 - on);
        }
    }
    vec![("relay.csv", table)]
}
