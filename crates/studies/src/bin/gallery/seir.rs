//! An epidemic with only the infectious counted, as a share of the population. Noise of 0.0003.

use sidc_testing::integrate::{grid, integrate};
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f =
        |_: f64, &[s, e, i]: &[f64; 3]| [-0.5 * s * i, 0.5 * s * i - 0.2 * e, 0.2 * e - 0.1 * i];
    let times = grid(640, 0.25);
    let mut random = Random::new(35);
    let mut state = [0.999, 0.0, 0.001];
    let mut table = Table::new(&["t", "I"]);
    for t in times {
        table.push(&[t, decimals(state[2] + 0.0003 * random.normal(), 5)]);
        state = integrate(&f, t, t + 0.25, state);
    }
    vec![("seir.csv", table)]
}
