//! Laws driven by white noise or slow forces: their terms, their intervals, what is reported of the disturbance, and where it is a doubt.

use std::fs;

use serde_json::Value;
use sidc_testing::integrate::{grid, integrate};
use sidc_testing::program::{Run, sidc_in};
use sidc_testing::random::Random;
use sidc_testing::stochastic::path;

const STEP: f64 = 0.05;

/// The columns as a table with a time column.
fn csv(names: &str, columns: &[Vec<f64>]) -> String {
    let mut text = format!("t,{names}\n");
    for (k, t) in grid(columns[0].len(), STEP).iter().enumerate() {
        let cells: Vec<String> = columns.iter().map(|c| c[k].to_string()).collect();
        text.push_str(&format!("{t},{}\n", cells.join(",")));
    }
    text
}

/// Runs a model on a table. Returns the run and the document.
pub fn identify(model: &str, data: &str, more: &[&str]) -> (Run, Value) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("m.sid"), model).unwrap();
    fs::write(folder.path().join("d.csv"), data).unwrap();
    let arguments = ["identify", "m.sid", "d.csv", "-o", "r.json"];
    let run = sidc_in(folder.path(), &[&arguments[..], more].concat());
    let found = fs::read_to_string(folder.path().join("r.json"));
    let found = found.unwrap_or_else(|_| panic!("{}", run.stderr));
    (run, serde_json::from_str(&found).unwrap())
}

/// The errors of the coefficients of the only equation, in standard errors. Its terms must be those given.
fn deviations(found: &Value, truth: &[(&str, f64)]) -> Vec<f64> {
    let terms = found["equations"][0]["terms"].as_array().unwrap();
    let names: Vec<&str> = terms.iter().map(|t| t["term"].as_str().unwrap()).collect();
    let known: Vec<&str> = truth.iter().map(|t| t.0).collect();
    assert_eq!(names, known);
    let off = |(t, (_, value)): (&Value, &(&str, f64))| {
        (t["coefficient"].as_f64().unwrap() - value) / t["standard_error"].as_f64().unwrap()
    };
    terms.iter().zip(truth).map(off).collect()
}

fn codes(found: &Value) -> Vec<&str> {
    let reasons = found["equations"][0]["reasons"].as_array();
    let reasons = reasons.into_iter().flatten();
    reasons.map(|r| r["code"].as_str().unwrap()).collect()
}

fn disturbance(found: &Value) -> &Value {
    &found["equations"][0]["evidence"]["together"]["disturbance"]
}

/// Positions of a double well driven by white noise, read with sensor noise of this size.
fn double_well(seed: u64, sensor: f64) -> String {
    let mut random = Random::new(seed);
    let law = |x: &[f64; 1]| [x[0] - x[0].powi(3)];
    let path = path(&law, [0.5], [0.2], (8001, STEP), &mut random);
    let read = path.iter().map(|x| x[0] + sensor * random.normal());
    csv("x", &[read.collect()])
}

#[test]
fn a_double_well_driven_by_white_noise_is_found_with_its_noise() {
    let truth = [("x", 1.0), ("x^3", -1.0)];
    for (seed, sensor) in [(1, 0.0), (2, 0.0), (3, 0.04)] {
        let data = double_well(seed, sensor);
        let (run, found) = identify("state x : order 1\ndx ~ poly(x; 5)\n", &data, &[]);
        for off in deviations(&found, &truth) {
            assert!(off.abs() < 3.5, "seed {seed}: {off}");
        }
        let size = disturbance(&found)["size"].as_f64().unwrap();
        assert!((size - 0.5).abs() < 0.03, "{size}");
        assert_eq!(disturbance(&found)["memory"], Value::Null);
        let told = "white noise drives dx too: in 1 s it moves x by 0.";
        assert!(run.stdout.contains(told), "{}", run.stdout);
        assert!(!codes(&found).contains(&"disturbed"));
    }
}

#[test]
fn reports_and_code_name_the_disturbance() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("m.sid"),
        "state x : order 1\ndx ~ poly(x; 5)\n",
    )
    .unwrap();
    fs::write(folder.path().join("d.csv"), double_well(1, 0.0)).unwrap();
    let run = sidc_in(
        folder.path(),
        &["identify", "m.sid", "d.csv", "-o", "r.json"],
    );
    assert_eq!(run.status, 0, "{}", run.stderr);
    let report = sidc_in(
        folder.path(),
        &["report", "r.json", "d.csv", "-o", "r.html"],
    );
    assert_eq!(report.status, 0, "{}", report.stderr);
    let said = "white noise drives dx too: in 1 s it moves x by 0.";
    let page = fs::read_to_string(folder.path().join("r.html")).unwrap();
    assert!(page.contains(said));
    for target in ["python", "c", "rust", "matlab"] {
        let code = sidc_in(folder.path(), &["export", "r.json", "--to", target]).stdout;
        assert!(code.contains(said), "{target}: {code}");
    }
}

#[test]
fn an_oscillator_driven_by_white_noise_is_found_from_its_position() {
    let mut random = Random::new(5);
    let law = |x: &[f64; 2]| [x[1], 2.0 * (1.0 - x[0] * x[0]) * x[1] - x[0]];
    let path = path(&law, [0.0, 0.3], [1.0, 0.0], (2001, STEP), &mut random);
    let data = csv("x", &[path.iter().map(|x| x[0]).collect()]);
    let (run, found) = identify("state x : order 2\nddx ~ poly(x, dx; 3)\n", &data, &[]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    let truth = [("x", -1.0), ("dx", 2.0), ("x^2*dx", -2.0)];
    for off in deviations(&found, &truth) {
        assert!(off.abs() < 3.5, "{off}");
    }
}

/// A pendulum in gusts correlated over half a second, read with noise of 0.002.
fn gusts() -> String {
    let mut random = Random::new(8);
    let law = |x: &[f64; 3]| {
        let gust = x[2];
        [x[1], -20.0 * x[0].sin() - 0.4 * x[1] + gust, -2.0 * gust]
    };
    let path = path(
        &law,
        [0.0, 0.0, 3.0],
        [0.5, 0.0, 0.0],
        (2001, STEP),
        &mut random,
    );
    let read = path.iter().map(|x| x[0] + 0.002 * random.normal());
    csv("x", &[read.collect()])
}

#[test]
fn a_force_that_lasts_is_estimated_with_the_law_and_doubted() {
    let model = "state x : order 2\nddx ~ <1, x, dx, sin x, cos x, x^2, dx^2, x*dx>\n";
    let (run, found) = identify(model, &gusts(), &[]);
    for off in deviations(&found, &[("dx", -0.4), ("sin(x)", -20.0)]) {
        assert!(off.abs() < 3.5, "{off}\n{}", run.stdout);
    }
    // 3 / √(2·2) = 1.5, with a correlation time of 1/2 s.
    let size = disturbance(&found)["size"].as_f64().unwrap();
    let memory = disturbance(&found)["memory"].as_f64().unwrap();
    assert!((size / 1.5 - 1.0).abs() < 0.2, "{size}");
    assert!((memory / 0.5 - 1.0).abs() < 0.3, "{memory}");
    assert_eq!(run.status, 3);
    assert!(codes(&found).contains(&"disturbed"), "{}", run.stdout);
}

/// A mass on a spring under forces that change at every sample and are recorded with noise of 0.7: x, u.
fn forced(seed: u64) -> String {
    let mut random = Random::new(seed);
    let mut z = [0.3, 0.0];
    let (mut x, mut u) = (Vec::new(), Vec::new());
    for _ in 0..1500 {
        let force = 1.5 * random.normal();
        x.push(z[0] + 0.001 * random.normal());
        u.push(force + 0.7 * random.normal());
        let rate = |_: f64, z: &[f64; 2]| [z[1], -4.0 * z[0] - 0.5 * z[1] + force];
        z = integrate(&rate, 0.0, STEP, z);
    }
    csv("x,u", &[x, u])
}

#[test]
fn declared_noise_of_an_input_no_longer_shrinks_its_coefficient() {
    let truth = [("x", -4.0), ("dx", -0.5), ("u", 1.0)];
    let model = "state x : order 2\ninput u : hold, noise 0.7\nddx ~ poly(x, dx, u; 2)\n";
    let data = forced(1);
    let (run, found) = identify(model, &data, &[]);
    for off in deviations(&found, &truth) {
        assert!(off.abs() < 3.5, "{off}\n{}", run.stdout);
    }
    // Without the declared noise of the input, its coefficient becomes 1.5²/(1.5² + 0.7²) = 0.82.
    let (_, found) = identify(&model.replace(", noise 0.7", ""), &data, &[]);
    assert!(deviations(&found, &truth)[2] < -6.0);
}

#[test]
fn noise_of_an_input_that_is_not_estimated_is_said() {
    let model = "state x : order 2\ninput u : linear, noise 0.7\nddx ~ <x, dx, u>\n";
    let (run, _) = identify(model, &forced(2), &[]);
    let warned = "warning[input-noise-unused]: u is taken as it is read";
    assert!(run.stderr.contains(warned), "{}", run.stderr);
}

#[test]
fn laws_that_explain_the_readings_have_no_disturbance() {
    let mut random = Random::new(9);
    let law = |x: &[f64; 2]| [x[1], -20.0 * x[0].sin() - 0.4 * x[1]];
    let path = path(&law, [0.0, 0.0], [1.5, 0.0], (401, STEP), &mut random);
    let read = path.iter().map(|x| x[0] + 0.01 * random.normal());
    let data = csv("x", &[read.collect()]);
    let model = "state x : order 2\nddx ~ <1, x, dx, sin x, cos x>\n";
    let (run, found) = identify(model, &data, &[]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    assert_eq!(disturbance(&found), &Value::Null);
}

#[test]
fn a_term_that_disturbances_make_needless_is_dropped() {
    // A heated house for a week; some rows are lost, so that the heater is switched at other instants than its record says.
    let outside = |t: f64| 8.0 + 6.0 * (0.2618 * (t - 9.0)).sin() + 2.0 * (0.07 * t).sin();
    let sun = |t: f64| 500.0 * (0.2618 * (t - 6.0)).sin().max(0.0);
    let mut random = Random::new(1);
    let (mut state, mut heat) = ([18.0], 0.0);
    let mut text = String::from("t,T,To,S,H\n");
    for (k, t) in grid(672, 0.25).into_iter().enumerate() {
        if k % 12 == 0 {
            heat = random.uniform(0.0, 4.0);
        }
        let read = state[0] + 0.06 * random.normal();
        if random.unit() > 0.05 {
            text += &format!("{t},{read},{},{},{heat}\n", outside(t), sun(t));
        }
        let law = |t: f64, x: &[f64; 1]| [0.05 * (outside(t) - x[0]) + 0.4 * heat + 0.003 * sun(t)];
        state = integrate(&law, t, t + 0.25, state);
    }
    let model =
        "state T\ninput To : cubic\ninput S : linear\ninput H : hold\ndT ~ poly(T, To, S, H; 2)\n";
    let (run, found) = identify(model, &text, &[]);
    assert!(run.stdout.contains("law: passes"), "{}", run.stdout);
    let terms = found["equations"][0]["terms"].as_array().unwrap();
    assert_eq!(terms.len(), 4, "{}", run.stdout);
}
