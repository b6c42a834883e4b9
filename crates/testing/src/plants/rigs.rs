//! Rigs as in laboratories: sampled inputs, sensors with noise or quantization, a state that is not measured.
//!
//! In: nothing; the numbers are fixed. Out: the text of a table. These tables replace measured records of such rigs, whose licences allow
//! no copy.

use std::f64::consts::TAU;

use crate::integrate::integrate;
use crate::random::Random;
use crate::table::Table;

/// Seconds between the samples of [`cascaded_tanks`].
const TANKS_STEP: f64 = 4.0;
/// A tank overflows at this level, V of its sensor.
const FULL: f64 = 10.0;

/// Two water tanks, one above the other; a pump fills the upper one and only the level of the lower one is measured. Levels follow
/// Torricelli's law. Columns t (s), u (V of the pump), y (V of the level's sensor, noise 0.01 V).
pub fn cascaded_tanks() -> String {
    let mut random = Random::new(3);
    let mut table = Table::new(&["t", "u", "y"]);
    let (mut levels, mut pump, mut held) = ([6.0, 5.0], 0.0, 0);
    for k in 0..1024 {
        if held == 0 {
            pump = random.uniform(1.0, 6.0);
            held = random.whole(4, 15);
        }
        held -= 1;
        let time = TANKS_STEP * f64::from(k);
        table.push(&[time, pump, levels[1] + 0.01 * random.normal()]);
        let rates = |_: f64, x: &[f64; 2]| {
            let [upper, lower] = x.map(|level| level.max(0.0).sqrt());
            [-0.054 * upper + 0.03 * pump, 0.05 * upper - 0.05 * lower]
        };
        let next = integrate(&rates, 0.0, TANKS_STEP, levels);
        levels = next.map(|level| level.min(FULL));
    }
    table.csv()
}

/// Samples per second of [`duffing_circuit`].
const CIRCUIT_RATE: f64 = 610.0;
/// What the converter of the circuit reads at zero, V.
pub const CIRCUIT_OFFSET: f64 = 0.003;
/// Steps of the converter per volt.
const CIRCUIT_STEPS: f64 = 8192.0;
/// The coefficients of y, ẏ, y³ and u in ÿ.
pub const CIRCUIT: [f64; 4] = [-1.8e5, -40.0, -6e5, 1.9e5];

/// A mass on a hardening spring as an electronic circuit, driven by sixty sines; its converter quantizes and has an offset. Columns t (s),
/// u (V, linear between samples), y (V).
pub fn duffing_circuit() -> String {
    let rows = 4000;
    let mut random = Random::new(5);
    let phases: Vec<f64> = (0..60).map(|_| random.uniform(0.0, TAU)).collect();
    let input = |k: usize| -> f64 {
        let time = k as f64 / CIRCUIT_RATE;
        let sines = phases.iter().zip(0_u32..);
        let sines = sines.map(|(phase, i)| (TAU * f64::from(1 + 2 * i) * time + phase).cos());
        (0.012 * sines.sum::<f64>() * 1e6).round() / 1e6
    };
    let inputs: Vec<f64> = (0..=rows).map(input).collect();
    let [y, dy, y3, u] = CIRCUIT;
    let mut table = Table::new(&["t", "u", "y"]);
    let mut state = [0.0, 0.0];
    for (k, pair) in inputs.windows(2).enumerate() {
        let read = ((state[0] + CIRCUIT_OFFSET) * CIRCUIT_STEPS).round() / CIRCUIT_STEPS;
        table.push(&[k as f64 / CIRCUIT_RATE, pair[0], read]);
        let rates = |t: f64, x: &[f64; 2]| {
            let input = pair[0] + (pair[1] - pair[0]) * t * CIRCUIT_RATE;
            [x[1], y * x[0] + dy * x[1] + y3 * x[0].powi(3) + u * input]
        };
        state = integrate(&rates, 0.0, 1.0 / CIRCUIT_RATE, state);
    }
    table.csv()
}
