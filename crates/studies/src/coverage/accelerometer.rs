//! A pendulum with exact angle and speed and a noisy acceleration from an accelerometer: least squares with a noisy target.
//!
//! In: nothing. Out: cases with white noise, and with noise that is correlated over some samples, as after a filter.

use super::case::{Case, Motion, Sensor, deviation};
use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

const MODEL: &str = "system pendulum
state theta : order 2
ddtheta ~ poly(theta, dtheta; 3) + <sin theta, cos theta, dtheta*sin theta, dtheta*cos theta>
";
/// Correlation between samples after a filter over five samples.
const FILTERED: f64 = 0.8;

pub fn cases() -> Vec<Case> {
    vec![
        pendulum("accelerometer", 0.0),
        pendulum("accelerometer_filtered", FILTERED),
    ]
}

fn pendulum(name: &'static str, memory: f64) -> Case {
    let acceleration = |x: &[f64; 2]| -9.81 * x[0].sin() - 0.2 * x[1];
    let f = |_: f64, x: &[f64; 2]| [x[1], acceleration(x)];
    let times = grid(1001, 0.01);
    let mut table = Table::new(&["t", "theta", "dtheta", "ddtheta"]);
    for (t, x) in times.iter().zip(free(&f, &times, [2.0, 0.0])) {
        table.push(&[*t, x[0], x[1], acceleration(&x)]);
    }
    let tables = vec![table];
    Case {
        name,
        model: MODEL.into(),
        laws: vec![("ddtheta", vec![("dtheta", -0.2), ("sin(theta)", -9.81)])],
        sensors: vec![Sensor {
            column: "ddtheta",
            size: deviation(&tables, 3),
            memory,
        }],
        motion: Motion::Fixed(tables),
    }
}
