//! A pendulum under a force known only at samples; between them it followed a smooth curve or straight lines.
//!
//! In: nothing. Out: the two cases. Their samples are nearly equal, and neither the record of the force nor its model says which is true.

use super::case::{Case, Motion, Sensor, deviation};
use sidc_testing::integrate::{grid, integrate};
use sidc_testing::table::Table;

const MODEL: &str = "system forced
state x : order 2
input u : linear
ddx ~ poly(x, dx, u; 2) + <sin x, cos x>
";
const ROWS: usize = 1001;
const STEP: f64 = 0.03;

pub fn cases() -> Vec<Case> {
    vec![
        forced("smooth_input", true),
        forced("straight_input", false),
    ]
}

/// Two sines, also between samples.
fn tones(t: f64) -> f64 {
    1.2 * (1.1 * t).sin() + 0.8 * (2.7 * t + 1.0).sin()
}

fn forced(name: &'static str, smooth: bool) -> Case {
    let mut table = Table::new(&["t", "x", "u"]);
    let mut state = [0.5, 0.0];
    for t in grid(ROWS, STEP) {
        table.push(&[t, state[0], tones(t)]);
        let (here, next) = (tones(t), tones(t + STEP));
        let u = |s: f64| match smooth {
            true => tones(s),
            false => here + (s - t) / STEP * (next - here),
        };
        let law = |s: f64, x: &[f64; 2]| [x[1], -4.0 * x[0].sin() - 0.5 * x[1] + 1.5 * u(s)];
        state = integrate(&law, t, t + STEP, state);
    }
    let tables = vec![table];
    Case {
        name,
        model: MODEL.into(),
        laws: vec![("ddx", vec![("sin(x)", -4.0), ("dx", -0.5), ("u", 1.5)])],
        sensors: vec![Sensor::white("x", deviation(&tables, 1))],
        motion: Motion::Fixed(tables),
    }
}
