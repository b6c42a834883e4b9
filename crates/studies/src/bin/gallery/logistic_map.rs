//! The logistic map in its chaotic regime.

use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let mut table = Table::new(&["x"]);
    // Iterates are written with all digits, so that each is the exact image of the one before in the file.
    table.digits = None;
    let mut x = 0.2;
    for _ in 0..200 {
        table.push(&[x]);
        x = 3.9 * x * (1.0 - x);
    }
    vec![("logistic_map.csv", table)]
}
