//! The same bob on four rods: L is constant in each run and differs between runs.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let times = grid(250, 0.02);
    let mut table = Table::new(&["run", "t", "L", "theta"]);
    for (run, (rod, start)) in [(0.25, 2.2), (0.4, -1.6), (0.6, 2.8), (1.0, -2.5)]
        .into_iter()
        .enumerate()
    {
        // Friction divided by the mass of the bob: 0.05 m²/s.
        let f = |_: f64, &[theta, speed]: &[f64; 2]| {
            [
                speed,
                -9.81 / rod * theta.sin() - 0.05 / (rod * rod) * speed,
            ]
        };
        for (t, [theta, _]) in times.iter().zip(free(&f, &times, [start, 0.0])) {
            table.push(&[run as f64 + 1.0, *t, rod, theta]);
        }
    }
    vec![("pendulum_lengths.csv", table)]
}
