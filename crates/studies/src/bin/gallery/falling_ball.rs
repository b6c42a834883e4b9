//! A light ball thrown up, dropped, and thrown down; its height is filmed.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |_: f64, &[_, speed]: &[f64; 2]| [speed, -9.81 - 0.11 * speed * speed.abs()];
    let times = grid(120, 0.02);
    let mut table = Table::new(&["throw", "t", "height"]);
    for (throw, start) in [[4.0, 14.0], [25.0, 0.0], [45.0, -20.0]]
        .into_iter()
        .enumerate()
    {
        for (t, [height, _]) in times.iter().zip(free(&f, &times, start)) {
            table.push(&[throw as f64 + 1.0, *t, height]);
        }
    }
    vec![("falling_ball.csv", table)]
}
