//! Stated parts of a model, with noisy positions: known terms, known equations, parameters, rational right sides.

use std::fs;

use serde_json::Value;

use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, sidc};

const STEP: f64 = 0.05;
const ROWS: usize = 400;
/// Noise relative to the standard deviation of the signal.
const NOISE: f64 = 0.01;
const LENGTHS: [f64; 3] = [0.5, 1.0, 2.0];

/// Positions and rates from `start` at rest, by Runge–Kutta with ten steps per sample.
fn motion(start: f64, rate: &dyn Fn(f64, f64) -> f64) -> [Vec<f64>; 2] {
    let f = |[x, v]: [f64; 2]| [v, rate(x, v)];
    let mut z = [start, 0.0];
    let mut out = [Vec::new(), Vec::new()];
    for _ in 0..ROWS {
        out[0].push(z[0]);
        out[1].push(z[1]);
        for _ in 0..10 {
            let h = STEP / 10.0;
            let ahead = |k: [f64; 2], h: f64| [z[0] + h * k[0], z[1] + h * k[1]];
            let a = f(z);
            let b = f(ahead(a, 0.5 * h));
            let c = f(ahead(b, 0.5 * h));
            let d = f(ahead(c, h));
            let sum = |i: usize| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0;
            z = ahead([sum(0), sum(1)], h);
        }
    }
    out
}

fn noisy(x: &[f64], random: &mut Random) -> Vec<f64> {
    let size = (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
    x.iter()
        .map(|x| x + NOISE * size * random.normal())
        .collect()
}

fn table(columns: &[(&str, Vec<f64>)]) -> String {
    let names: Vec<&str> = columns.iter().map(|(n, _)| *n).collect();
    let mut text = format!("t,{}\n", names.join(","));
    for k in 0..ROWS {
        let cells: Vec<String> = columns.iter().map(|(_, c)| c[k].to_string()).collect();
        text.push_str(&format!("{},{}\n", k as f64 * STEP, cells.join(",")));
    }
    text
}

/// A pendulum of each length, −9.81/L sin θ − 0.3 ω: angle, optionally rate, and optionally the length as a column.
fn pendulums(rate: bool, length: bool) -> Vec<String> {
    let mut random = Random::new(5);
    let one = |l: f64| {
        let [theta, omega] = motion(2.2 - 0.3 * l, &|x, v| -9.81 / l * x.sin() - 0.3 * v);
        let mut columns = vec![("theta", noisy(&theta, &mut random))];
        if rate {
            columns.push(("omega", noisy(&omega, &mut random)));
        }
        if length {
            columns.push(("L", vec![l; ROWS]));
        }
        table(&columns)
    };
    LENGTHS.into_iter().map(one).collect()
}

fn identify(model: &str, tables: &[String], more: &[&str]) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: String, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_string()
    };
    let mut args = vec![write("m.sid".into(), model)];
    let files = (1..).zip(tables);
    args.extend(files.map(|(i, t)| write(format!("run{i}.csv"), t)));
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    sidc(&[&["identify", "-q"], &args[..], more].concat())
}

/// The last equation has exactly these terms and no doubt.
fn found(model: &str, tables: &[String], more: &[&str], wanted: &[(&str, f64)], part: f64) {
    let run = identify(model, tables, &[more, &["--json"]].concat());
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    let doc: Value = serde_json::from_str(&run.stdout).unwrap();
    let equation = doc["equations"].as_array().unwrap().last().unwrap().clone();
    let terms = equation["terms"].as_array().unwrap();
    assert_eq!(terms.len(), wanted.len(), "{equation:#}");
    for (name, value) in wanted {
        let term = terms.iter().find(|t| t["term"] == *name);
        let term = term.unwrap_or_else(|| panic!("no {name}: {equation:#}"));
        let a = term["coefficient"].as_f64().unwrap();
        assert!((a - value).abs() < part * value.abs(), "{name}: {a}");
    }
}

#[test]
fn a_known_part_is_kept_and_the_rest_is_found() {
    let model = "state theta : order 2
param L
ddtheta ~ known(-9.81/L * sin theta) + poly(theta, dtheta; 3)\n";
    let wanted = [("sin(theta)/L", -9.81), ("dtheta", -0.3)];
    found(model, &pendulums(false, true), &[], &wanted, 0.01);
}

#[test]
fn a_known_part_may_be_the_smaller_one() {
    let model = "state theta : order 2
param L
ddtheta ~ known(-0.3*dtheta) + <sin theta, sin(2*theta), theta, dtheta*abs(dtheta)> * <1, 1/L, 1/L^2>\n";
    let wanted = [("sin(theta)/L", -9.81), ("dtheta", -0.3)];
    found(model, &pendulums(false, true), &[], &wanted, 0.002);
}

#[test]
fn a_known_equation_leads_the_measured_rate() {
    let model = "state theta, omega
param L
dtheta = omega
domega ~ known(-9.81/L * sin theta) + poly(omega, theta; 3)\n";
    let wanted = [("sin(theta)/L", -9.81), ("omega", -0.3)];
    found(model, &pendulums(true, true), &[], &wanted, 0.01);
    let model = "state theta, omega
param L
dtheta = omega
domega ~ <sin theta, theta, omega, omega*abs(omega)> * <1, 1/L, 1/L^2>\n";
    found(model, &pendulums(true, true), &[], &wanted, 0.01);
}

#[test]
fn a_rate_without_a_column_is_said_to_be_a_derivative() {
    let model = "state theta, omega\nparam L\ndtheta = omega\ndomega ~ <sin(theta)/L, omega>\n";
    let run = identify(model, &pendulums(false, true), &[]);
    assert_eq!(run.status, 1, "{}", run.stderr);
    let help = "a rate of what is measured needs no column: state theta : order 2, then ddtheta for domega and dtheta for omega";
    // Long lines are wrapped.
    let words: Vec<&str> = run.stderr.split_whitespace().collect();
    assert!(words.join(" ").contains(help), "{}", run.stderr);
    let model = "state theta : order 2\nparam L\nddtheta ~ <sin(theta)/L, dtheta>\n";
    let wanted = [("sin(theta)/L", -9.81), ("dtheta", -0.3)];
    found(model, &pendulums(false, true), &[], &wanted, 0.01);
}

#[test]
fn parameters_of_files_tell_powers_apart() {
    let model = "state theta : order 2
param L
ddtheta ~ <sin theta, sin(2*theta), dtheta, dtheta*abs(dtheta)> * <1, 1/L, 1/L^2>\n";
    let wanted = [("sin(theta)/L", -9.81), ("dtheta", -0.3)];
    let option = ["--param", "L=0.5,1,2"];
    found(model, &pendulums(false, false), &option, &wanted, 0.01);
}

#[test]
fn a_rational_right_side_is_found_from_positions() {
    let mut random = Random::new(8);
    let one = |start: f64| {
        let [x, _] = motion(start, &|x, v| (-4.0 * x - 0.3 * v) / (1.0 + 0.5 * x * x));
        table(&[("x", noisy(&x, &mut random))])
    };
    let tables: Vec<String> = [2.0, 1.7, 1.4].into_iter().map(one).collect();
    let model = "state x : order 2\nddx ~ poly(x, dx; 3) + ddx * <x, dx, x^2, dx^2>\n";
    let wanted = [("x", -4.0), ("dx", -0.3), ("x^2*ddx", -0.5)];
    found(model, &tables, &[], &wanted, 0.02);
}
