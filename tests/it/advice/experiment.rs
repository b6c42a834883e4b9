//! Simulated experiments: motions of known laws, read by noisy sensors.

use sidc_testing::integrate::{grid, integrate};
use sidc_testing::pendulum_regression::Random;
use sidc_testing::table::Table;

/// Samples of each state of a law.
pub fn motion<const N: usize>(
    rate: impl Fn(f64, &[f64; N]) -> [f64; N],
    start: [f64; N],
    step: f64,
    rows: usize,
) -> [Vec<f64>; N] {
    let mut z = start;
    let mut states: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
    for t in grid(rows, step) {
        states.iter_mut().zip(z).for_each(|(s, x)| s.push(x));
        z = integrate(&rate, t, t + step, z);
    }
    states
}

/// The angle of a pendulum with ddx = −9.81 sin x − 0.1 dx.
pub fn swing(start: f64, step: f64, rows: usize) -> Vec<f64> {
    let rate = |_: f64, z: &[f64; 2]| [z[1], -9.81 * z[0].sin() - 0.1 * z[1]];
    let [x, _] = motion(rate, [start, 0.0], step, rows);
    x
}

/// A signal as a sensor reads it.
pub fn read(x: &[f64], sigma: f64, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    x.iter().map(|x| x + sigma * random.normal()).collect()
}

/// Random levels between −1 and 1, each held for `hold` samples.
pub fn levels(rows: usize, hold: usize, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    let levels: Vec<f64> = (0..=rows / hold)
        .map(|_| 2.0 * random.uniform() - 1.0)
        .collect();
    (0..rows).map(|k| levels[k / hold]).collect()
}

/// Standard normal numbers.
pub fn normal(rows: usize, seed: u64) -> Vec<f64> {
    read(&vec![0.0; rows], 1.0, seed)
}

/// Columns over time, as CSV with all digits.
pub fn record(step: f64, columns: &[(&'static str, &[f64])]) -> String {
    let names: Vec<&str> = std::iter::once("t")
        .chain(columns.iter().map(|c| c.0))
        .collect();
    let rows = columns.iter().map(|c| c.1.len()).min().unwrap_or(0);
    let row = |(k, t): (usize, f64)| -> Vec<f64> {
        std::iter::once(t)
            .chain(columns.iter().map(|c| c.1[k]))
            .collect()
    };
    Table {
        rows: grid(rows, step).into_iter().enumerate().map(row).collect(),
        digits: None,
        ..Table::new(&names)
    }
    .csv()
}
