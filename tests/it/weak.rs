//! `--method weak`: equations from noisy positions, inputs that jump, records with gaps and uneven times.

use std::fs;

use serde_json::Value;

use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::sidc;

/// One Runge–Kutta step.
fn step<const N: usize>(f: impl Fn([f64; N]) -> [f64; N], x: [f64; N], h: f64) -> [f64; N] {
    let moved = |k: [f64; N], by: f64| std::array::from_fn(|i| x[i] + by * k[i]);
    let k1 = f(x);
    let k2 = f(moved(k1, 0.5 * h));
    let k3 = f(moved(k2, 0.5 * h));
    let k4 = f(moved(k3, h));
    std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

/// Integrates from each time to the next in ten steps.
fn motion<const N: usize>(
    f: impl Fn(usize, [f64; N]) -> [f64; N],
    start: [f64; N],
    time: &[f64],
) -> Vec<[f64; N]> {
    let mut out = vec![start];
    for (k, pair) in time.windows(2).enumerate() {
        let mut x = out[k];
        for _ in 0..10 {
            x = step(|x| f(k, x), x, 0.1 * (pair[1] - pair[0]));
        }
        out.push(x);
    }
    out
}

fn even(count: u32, step: f64) -> Vec<f64> {
    (0..count).map(|k| f64::from(k) * step).collect()
}

/// Runs the program on the model and the table. Returns the result document.
fn identify(model: &str, table: &str, more: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let (m, d) = (folder.path().join("m.sid"), folder.path().join("d.csv"));
    fs::write(&m, model).unwrap();
    fs::write(&d, table).unwrap();
    let paths = [m.to_str().unwrap(), d.to_str().unwrap()];
    let run = sidc(&[&["identify", "-q", "--json"], &paths[..], more].concat());
    serde_json::from_str(&run.stdout).unwrap_or_else(|_| panic!("{}", run.stderr))
}

/// Terms and coefficients of one equation.
fn terms(document: &Value, target: &str) -> Vec<(String, f64)> {
    let all = document["equations"].as_array().unwrap();
    let equation = all.iter().find(|e| e["target"] == target).unwrap();
    let terms = equation["terms"].as_array().unwrap().iter();
    let pair = |t: &Value| {
        let name = t["term"].as_str().unwrap().to_string();
        (name, t["coefficient"].as_f64().unwrap())
    };
    terms.map(pair).collect()
}

/// Checks that the terms are exactly these, each within a relative tolerance.
fn near(document: &Value, target: &str, wanted: &[(&str, f64)], part: f64) {
    let found = terms(document, target);
    let names = |t: &(String, f64)| t.0.clone();
    let got: Vec<String> = found.iter().map(names).collect();
    let expected: Vec<&str> = wanted.iter().map(|(n, _)| *n).collect();
    assert_eq!(got, expected, "{target}: {found:?}");
    for ((name, a), (_, b)) in found.iter().zip(wanted) {
        assert!((a - b).abs() <= part * b.abs(), "{name}: {a}, not {b}");
    }
}

const WEAK: &[&str] = &["--method", "weak"];

/// Cart and pendulum, coupled and implicit, from positions and force alone, with noise of 1 % of 0.3 m and of 1 rad.
#[test]
fn a_cart_pendulum_is_found_from_noisy_positions() {
    let mut random = Random::new(5);
    let time = even(2000, 0.01);
    let mut force = Vec::new();
    while force.len() < time.len() {
        let (level, length) = (
            16.0 * random.uniform() - 8.0,
            10.0 + 50.0 * random.uniform(),
        );
        force.extend(vec![level; length as usize]);
    }
    let (total, ml, rod) = (0.775, 0.1375, 0.5);
    let plant = |k: usize, [_, dy, theta, dtheta]: [f64; 4]| {
        // (M + m) ÿ + m L θ̈ cos θ = F − c ẏ + m L θ̇² sin θ; L θ̈ + ÿ cos θ = −c θ̇ − g sin θ
        let right = force[k] - 0.05 * dy + ml * dtheta * dtheta * theta.sin();
        let torque = -0.0727 * dtheta - 9.8 * theta.sin();
        let cos = theta.cos();
        let ddy = (right - ml * cos * torque / rod) / (total - ml * cos * cos / rod);
        [dy, ddy, dtheta, (torque - ddy * cos) / rod]
    };
    let states = motion(plant, [0.0, 0.0, 0.5, 0.0], &time);
    let mut table = String::from("t,y,theta,F\n");
    for ((t, x), f) in time.iter().zip(states).zip(&force) {
        let (y, theta) = (
            x[0] + 0.003 * random.normal(),
            x[2] + 0.01 * random.normal(),
        );
        table.push_str(&format!("{t},{y},{theta},{f}\n"));
    }
    let model = "state y, theta : order 2\ninput F : hold\n\
        let base = poly(dy, theta, dtheta; 2) * <1, sin(theta), cos(theta), F>\n\
        ddy ~ base + ddtheta*<1, sin(theta), cos(theta)>\n\
        ddtheta ~ base + ddy*<1, sin(theta), cos(theta)>\n";
    let found = identify(model, &table, WEAK);
    let coupling = ml / total;
    near(
        &found,
        "ddy",
        &[
            ("dy", -0.05 / total),
            ("F", 1.0 / total),
            ("ddtheta*cos(theta)", -coupling),
            ("dtheta^2*sin(theta)", coupling),
        ],
        0.02,
    );
    near(
        &found,
        "ddtheta",
        &[
            ("dtheta", -0.1454),
            ("sin(theta)", -19.6),
            ("ddy*cos(theta)", -2.0),
        ],
        0.03,
    );
}

/// Predators and prey with noise of 20 %: smoothing biases the coefficients of a regression towards zero.
#[test]
fn first_order_systems_keep_their_coefficients_in_noise_that_biases_a_regression() {
    let mut random = Random::new(2);
    let time = even(600, 0.05);
    let states = motion(
        |_, [x, y]: [f64; 2]| [x - 0.5 * x * y, -0.8 * y + 0.4 * x * y],
        [3.0, 1.0],
        &time,
    );
    let mut table = String::from("t,x,y\n");
    for (t, [x, y]) in time.iter().zip(states) {
        let (x, y) = (x + 0.2 * random.normal(), y + 0.2 * random.normal());
        table.push_str(&format!("{t},{x},{y}\n"));
    }
    let model = "state x, y\ndx, dy ~ poly(x, y; 3)\n";
    let found = identify(model, &table, WEAK);
    near(&found, "dx", &[("x", 1.0), ("x*y", -0.5)], 0.03);
    near(&found, "dy", &[("y", -0.8), ("x*y", 0.4)], 0.03);
    let method = found["equations"][0]["evidence"]["method"].as_str();
    assert_eq!(method, Some("weak form, windows of ±1 samples"));
    assert_eq!(found["settings"]["method"], "weak");
    let biased = identify(model, &table, &["--method", "regression"]);
    let prey = terms(&biased, "dx")[0].1;
    assert!(prey < 0.96, "a regression would do as well: {prey}");
}

/// The force jumps every second sample, times are uneven, and seconds of the record are missing.
#[test]
fn jumps_of_inputs_are_crossed_and_gaps_are_not() {
    let mut random = Random::new(9);
    let mut time = vec![0.0];
    for k in 1..400 {
        let pause = if k == 200 { 4.0 } else { 0.0 };
        time.push(time[k - 1] + 0.02 + 0.01 * random.uniform() + pause);
    }
    let input: Vec<f64> = (0..400).map(|k| [1.0, -2.0, 0.5][(k / 2) % 3]).collect();
    let states = motion(
        |k, [x]: [f64; 1]| [-1.5 * x + 3.0 * input[k] - 0.2 * x * x * x],
        [0.7],
        &time,
    );
    let mut table = String::from("t,x,u\n");
    for ((t, [x]), u) in time.iter().zip(states).zip(&input) {
        table.push_str(&format!("{t},{x},{u}\n"));
    }
    let model = "state x\ninput u : hold\ndx ~ poly(x, u; 3)\n";
    let found = identify(model, &table, WEAK);
    near(
        &found,
        "dx",
        &[("x", -1.5), ("u", 3.0), ("x^3", -0.2)],
        1e-2,
    );
    // 400 samples in two pieces have 398 steps.
    assert_eq!(found["equations"][0]["evidence"]["rows"], 398);
}

/// If the target itself was measured, nothing needs to be integrated, so plain regression answers.
#[test]
fn measured_targets_are_regressed() {
    let rows = (0..60).map(|k| f64::from(k) * 0.1);
    let table: String = rows
        .map(|t| format!("{t},{},{}\n", t.sin(), 2.0 * t.sin()))
        .collect();
    let found = identify(
        "state x\ndx ~ poly(x; 2)\n",
        &format!("t,x,dx\n{table}"),
        WEAK,
    );
    near(&found, "dx", &[("x", 2.0)], 1e-9);
    assert_eq!(found["equations"][0]["evidence"]["method"], Value::Null);
}

#[test]
fn unknown_methods_are_refused_with_the_nearest_name() {
    let run = sidc(&["identify", "m.sid", "d.csv", "--method", "weka"]);
    assert_eq!(run.status, 2);
    assert!(run.stderr.contains("did you mean `weak`"), "{}", run.stderr);
}
