//! A direct-current motor with viscous and Coulomb friction, as logged on a test rig: milliseconds, degrees that wrap at 360, revolutions per minute, per
//! cent of 24 V, semicolons.
//!
//! Between changes of the command and reversals the motion is known in closed form, so nothing is integrated.

use sidc_testing::random::Random;
use sidc_testing::table::Table;
use std::f64::consts::PI;

/// ω̇ = PULL u − DRAG ω − STICK sign ω, with u in volts.
const PULL: f64 = 50.0;
const DRAG: f64 = 8.0;
const STICK: f64 = 60.0;
const STEP: f64 = 0.005;

pub fn tables() -> Vec<(&'static str, Table)> {
    let mut table = Table::new(&["Time (ms)", "Angle [deg]", "Speed [rpm]", "Cmd %"]);
    table.separator = ';';
    let (mut angle, mut speed) = (1.0_f64, 10.0_f64);
    for (k, command) in commands(800).into_iter().enumerate() {
        let degrees = (angle * 180.0 / PI).rem_euclid(360.0);
        table.push(&[k as f64 * 1e3 * STEP, degrees, speed * 30.0 / PI, command]);
        (angle, speed) = advance(angle, speed, command / 100.0 * 24.0, STEP);
    }
    vec![("dc_motor.csv", table)]
}

/// Levels of at least 15 %, so that the motor never stops: sign(ω) is undefined at rest.
fn commands(rows: usize) -> Vec<f64> {
    Random::new(41)
        .square(rows, (15, 60), 85.0)
        .iter()
        .map(|level| (level + 15.0 * level.signum()).round())
        .collect()
}

/// Angle and speed after `h` seconds at constant voltage.
fn advance(angle: f64, speed: f64, volts: f64, h: f64) -> (f64, f64) {
    let direction = if speed == 0.0 {
        volts.signum()
    } else {
        speed.signum()
    };
    let end = (PULL * volts - STICK * direction) / DRAG;
    let after = |t: f64| {
        let decay = (-DRAG * t).exp();
        (
            angle + end * t + (speed - end) * (1.0 - decay) / DRAG,
            end + (speed - end) * decay,
        )
    };
    // The speed passes zero where (speed − end) e^(−DRAG t) = −end.
    let zero = ((speed - end) / -end).ln() / DRAG;
    if speed != 0.0 && end * direction < 0.0 && zero < h {
        return advance(after(zero).0, 0.0, volts, h - zero);
    }
    after(h)
}
