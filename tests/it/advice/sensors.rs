//! Advice on sensors: noise, offset, delay, outliers.

use sidc_testing::records::{contradicting_rows, difference_equation};

use super::experiment::{levels, motion, normal, read, record};
use super::follow::{Case, Scenario};

/// In discrete time, the noise of a sensor is on both sides of the equation.
pub fn coloured_residuals() -> Scenario {
    let model = "state y\ninput u\nnext y ~ <y, lag(y, 1), u>\n";
    let case = Case::new(model, difference_equation(0.01, 0.03));
    Scenario::words(case, |case, _| {
        case.recorded(vec![difference_equation(0.01, 0.0)])
    })
}

pub fn inconsistent_rows() -> Scenario {
    let case = Case::new("state x, z\ndx ~ poly(x, z; 8)\n", contradicting_rows());
    Scenario::words(case, |case, _| case.clone().option("--noise dx=0.001"))
}

pub fn solver_inaccurate() -> Scenario {
    let (x, z) = (normal(60, 1), normal(60, 2));
    let dx: Vec<f64> = x.iter().map(|x| 2.0 * x).collect();
    let dx = read(&dx, 0.01, 3);
    let table = record(1.0, &[("x", &x), ("z", &z), ("dx", &dx)]);
    let case = Case::new("state x, z\ndx ~ poly(x, z, sin x, sin z; 5)\n", table);
    Scenario::words(case, |case, _| case.clone().option("--noise dx=0.01"))
}

/// A command that acts three samples late.
pub fn input_delay() -> Scenario {
    let model = "state x : order 2\ninput u : hold\nddx ~ poly(x, dx, u; 2)\n";
    Scenario::change(Case::new(model, late_command()))
}

/// The same, with a range that does not contain the delay.
pub fn delay_range() -> Scenario {
    let model = "state x : order 2\ninput u : hold, delay in 0..0.1\nddx ~ poly(x, dx; 2) + u\n";
    Scenario::change(Case::new(model, late_command()))
}

/// The record of a command that acts three samples of 0.05 s late.
fn late_command() -> String {
    const STEP: f64 = 0.05;
    let u: Vec<f64> = levels(300, 6, 9).iter().map(|u| 1.5 * u).collect();
    let mut z = [1.0, 0.0];
    let mut x = Vec::new();
    for k in 0..300 {
        let u = u[usize::saturating_sub(k, 3)];
        x.push(z[0]);
        let rate = |_: f64, z: &[f64; 2]| [z[1], -4.0 * z[0] - 0.4 * z[1] + u];
        let [a, b] = motion(rate, z, STEP, 2);
        z = [a[1], b[1]];
    }
    record(STEP, &[("x", &read(&x, 0.005, 4)), ("u", &u)])
}

/// Gusts correlated over ten samples, first unknown, then measured.
pub fn disturbed() -> Scenario {
    const STEP: f64 = 0.05;
    let fresh = normal(1500, 11);
    let (mut z, mut gust) = ([0.5, 0.0], 0.0);
    let (mut x, mut gusts) = (Vec::new(), Vec::new());
    for e in &fresh {
        gust = 0.9 * gust + 0.6 * e;
        x.push(z[0]);
        gusts.push(gust);
        let rate = |_: f64, z: &[f64; 2]| [z[1], -20.0 * z[0].sin() - 0.4 * z[1] + gust];
        let [a, b] = motion(rate, z, STEP, 2);
        z = [a[1], b[1]];
    }
    let x = read(&x, 0.002, 4);
    let model = "state x : order 2\nddx ~ <x, dx, sin x, x^2, x*dx>\n";
    let case = Case::new(model, record(STEP, &[("x", &x), ("g", &gusts)]));
    Scenario::words(case, |case, _| {
        let measured = case.rewritten("state x : order 2", "state x : order 2\ninput g : hold");
        measured.rewritten("<x,", "<g, x,")
    })
}

pub fn outliers() -> Scenario {
    let rate = |_: f64, z: &[f64; 2]| [z[1], -4.0 * z[0] - 0.4 * z[1]];
    let [x, _] = motion(rate, [1.0, 0.0], 0.05, 300);
    let mut x = read(&x, 0.005, 1);
    for (k, by) in [(40, 0.3), (150, -0.5), (222, 0.2)] {
        x[k] += by;
    }
    let model = "state x : order 2\nddx ~ poly(x, dx; 2)\n";
    Scenario::change(Case::new(model, record(0.05, &[("x", &x)])))
}

/// A rate sensor with an offset of 0.1.
pub fn rate_disagrees() -> Scenario {
    let rate = |_: f64, z: &[f64; 2]| [z[1], -8.0 * z[0].sin() - 0.3 * z[1]];
    let [x, dx] = motion(rate, [2.2, 0.4], 0.02, 700);
    let dx: Vec<f64> = dx.iter().map(|v| v + 0.1).collect();
    let model = "state x : order 2\nddx ~ <1, x, dx, dx^2, sin(x), cos(x)>\n";
    Scenario::change(Case::new(model, record(0.02, &[("x", &x), ("dx", &dx)])))
}

/// A fast oscillation with three samples per period, without and with an accelerometer.
pub fn rough_derivative() -> Scenario {
    let rate = |_: f64, z: &[f64; 2]| [z[1], -100.0 * z[0] - 0.2 * z[1]];
    let [x, dx] = motion(rate, [1.0, 0.0], 0.2, 120);
    let rates = x.iter().zip(&dx);
    let ddx: Vec<f64> = rates.map(|(x, dx)| -100.0 * x - 0.2 * dx).collect();
    let measured = record(0.2, &[("x", &x), ("ddx", &read(&ddx, 0.1, 2))]);
    let model = "state x : order 2\nddx ~ <x, dx, x^3>\n";
    let case = Case::new(model, record(0.2, &[("x", &x)])).option("--method regression");
    Scenario::words(case, move |case, _| case.recorded(vec![measured.clone()]))
}

/// A pendulum whose sensor has an offset of 0.2.
pub fn sensor_offset() -> Scenario {
    let rate = |_: f64, z: &[f64; 2]| {
        [
            z[1],
            -9.0 * z[0].sin() - 0.3 * z[1] + 2.0 * (2.0 * z[0]).sin(),
        ]
    };
    let [x, _] = motion(rate, [2.5, 0.0], 0.05, 400);
    let x: Vec<f64> = read(&x, 0.003, 3).iter().map(|x| x + 0.2).collect();
    let model = "state x : order 2\nddx ~ <1, x, dx, dx^2, sin(x), cos(x), sin(2*x), cos(2*x)>\n";
    Scenario::change(Case::new(model, record(0.05, &[("x", &x)])))
}
