//! Two outbreaks of the same disease in towns with different immunity; one file each.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |_: f64, &[s, i]: &[f64; 2]| [-0.4 * s * i, 0.4 * s * i - 0.1 * i];
    let times = grid(200, 0.5);
    let outbreak = |start: [f64; 2]| {
        let mut table = Table::new(&["t", "S", "I"]);
        for (t, [s, i]) in times.iter().zip(free(&f, &times, start)) {
            table.push(&[*t, s, i]);
        }
        table
    };
    vec![
        ("sir_a.csv", outbreak([0.98, 0.02])),
        ("sir_b.csv", outbreak([0.55, 0.10])),
    ]
}
