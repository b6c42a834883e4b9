//! Sensor noise that is correlated in time, declared or found, and what must not be taken for it.

use std::path::Path;

use serde_json::Value;
use sidc_testing::integrate::{grid, integrate};
use sidc_testing::program::{Run, sidc};
use sidc_testing::random::Random;

const STEP: f64 = 0.05;
const MODEL: &str = "state x, y\ndx, dy ~ poly(x, y; 3)\n";
const TRUTH: [&[(&str, f64)]; 2] = [&[("y", 1.0)], &[("x", -1.0), ("y", 2.0), ("x^2*y", -2.0)]];

/// The van der Pol oscillator, 401 samples of both states, with noise of this size and correlation time (s; 0 is white).
fn oscillator(size: f64, memory: f64, seed: u64) -> String {
    let mut random = Random::new(seed);
    let lasting = if memory > 0.0 {
        (-STEP / memory).exp()
    } else {
        0.0
    };
    let law = |_: f64, z: &[f64; 2]| [z[1], 2.0 * (1.0 - z[0] * z[0]) * z[1] - z[0]];
    let mut z = [1.0, 0.0];
    let mut error = [0.0; 2].map(|_: f64| random.normal());
    let mut text = "t,x,y\n".to_string();
    for t in grid(401, STEP) {
        text.push_str(&format!(
            "{t},{},{}\n",
            z[0] + size * error[0],
            z[1] + size * error[1]
        ));
        error = error.map(|e| lasting * e + (1.0 - lasting * lasting).sqrt() * random.normal());
        z = integrate(&law, t, t + STEP, z);
    }
    text
}

fn identify(model: &str, data: &str, more: &[&str]) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let write = |name: &str, text: &str| std::fs::write(Path::new(&path(name)), text).unwrap();
    write("m.sid", model);
    write("d.csv", data);
    sidc(&[&["identify", "-q", &path("m.sid"), &path("d.csv")], more].concat())
}

fn document(model: &str, data: &str) -> Value {
    let run = identify(model, data, &["--json"]);
    serde_json::from_str(&run.stdout).unwrap_or_else(|e| panic!("{e}: {}", run.stderr))
}

/// How many coefficients are in their intervals, and how many there are; `None` if the terms are not the true ones.
fn inside(document: &Value) -> Option<(usize, usize)> {
    let (mut inside, mut all) = (0, 0);
    for (equation, truth) in document["equations"].as_array()?.iter().zip(TRUTH) {
        let terms = equation["terms"].as_array()?;
        if terms.len() != truth.len() {
            return None;
        }
        for (name, value) in truth {
            let term = terms.iter().find(|t| t["term"] == *name)?;
            let end = |i: usize| term["interval"][i].as_f64();
            inside += usize::from((end(0)?..=end(1)?).contains(value));
            all += 1;
        }
    }
    Some((inside, all))
}

fn channels(document: &Value) -> impl Iterator<Item = &Value> {
    let equations = document["equations"].as_array().unwrap().iter();
    equations.map(|e| &e["evidence"]["together"]["channels"][0])
}

#[test]
fn noise_that_lasts_is_found_and_intervals_hold_the_truth() {
    let (mut in_all, mut of_all) = (0, 0);
    for seed in 0..6 {
        let found = document(MODEL, &oscillator(0.05, 0.2, seed));
        let (inside, all) = inside(&found).expect("the true terms");
        in_all += inside;
        of_all += all;
        for channel in channels(&found) {
            let memory = channel["lasting"].as_f64().expect("noise that lasts");
            assert!((0.1..0.4).contains(&memory), "{memory}");
            let size = channel["left"].as_f64().unwrap();
            assert!((0.04..0.06).contains(&size), "{size}");
        }
        assert!(found["equations"][1]["evidence"]["together"]["disturbance"].is_null());
    }
    // 24 intervals of 95 %: the chance of fewer than 20 hits is 1 %.
    assert!(in_all >= 20, "{in_all} of {of_all}");
}

#[test]
fn declared_memory_gives_what_is_found() {
    let model = MODEL.replace("x, y\n", "x, y : memory 0.2\n");
    let data = oscillator(0.05, 0.2, 2);
    let (said, found) = (document(&model, &data), document(MODEL, &data));
    assert!(channels(&said).all(|c| c["lasting"] == 0.2));
    for (a, b) in [(0, 0), (1, 0), (1, 1), (1, 2)] {
        let term = |d: &Value| {
            let term = &d["equations"][a]["terms"][b];
            (
                term["coefficient"].as_f64().unwrap(),
                term["standard_error"].as_f64().unwrap(),
            )
        };
        let ((one, error), (other, _)) = (term(&said), term(&found));
        assert!((one - other).abs() < 0.5 * error, "{one} {other} {error}");
    }
}

#[test]
fn white_noise_is_not_said_to_last() {
    for seed in 0..4 {
        let found = document(MODEL, &oscillator(0.05, 0.0, seed));
        assert!(channels(&found).all(|c| c["lasting"].is_null()), "{seed}");
    }
    // Nor if it is correlated and the model says that it is not.
    let model = MODEL.replace("x, y\n", "x, y : memory 0\n");
    let found = document(&model, &oscillator(0.05, 0.1, 1));
    assert!(channels(&found).all(|c| c["lasting"].is_null()));
}

#[test]
fn a_law_without_its_damping_is_not_explained_by_noise() {
    let model = "state x, y\ndx ~ poly(x, y; 1)\ndy ~ poly(x, y; 1)\n";
    let run = identify(model, &oscillator(0.05, 0.2, 3), &[]);
    assert_eq!(run.status, 3, "{}", run.stdout);
}

#[test]
fn noise_that_lasts_is_said() {
    let run = identify(MODEL, &oscillator(0.05, 0.2, 5), &["--evidence"]);
    let said = run.stdout.lines().filter(|l| l.contains(" of x"));
    let said: Vec<&str> = said
        .map(str::trim)
        .filter(|l| l.contains("noise"))
        .collect();
    insta::assert_snapshot!("noise_that_lasts_is_said", said.join("\n"));
}

#[test]
fn other_methods_say_that_they_take_it_for_white() {
    let model = MODEL.replace("x, y\n", "x, y : memory 0.2\n");
    let run = identify(&model, &oscillator(0.05, 0.2, 1), &["--method", "weak"]);
    assert!(
        run.stderr
            .contains("warning[memory-unused]: the noise of x"),
        "{}",
        run.stderr
    );
}
