//! Predators and prey with only the prey counted. Noise of 0.03.

use sidc_testing::integrate::{grid, integrate};
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f =
        |_: f64, &[prey, fox]: &[f64; 2]| [prey - 0.4 * prey * fox, 0.3 * prey * fox - 0.8 * fox];
    let times = grid(800, 0.05);
    let mut random = Random::new(36);
    let mut state = [4.0, 1.5];
    let mut table = Table::new(&["t", "prey"]);
    for t in times {
        table.push(&[t, decimals(state[0] + 0.03 * random.normal(), 3)]);
        state = integrate(&f, t, t + 0.05, state);
    }
    vec![("predator.csv", table)]
}
