//! The choice of the method: clean records are recognised; if regression of measured rates is doubted, the joint estimate is tried; the method that passes is
//! given, and both are named.

use std::fs;
use std::path::Path;

use serde_json::Value;
use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, sidc};

const STEP: f64 = 0.05;
const ROWS: usize = 400;

/// Two species: dx = x − x y/2, dy = −0.8 y + 0.4 x y.
fn law([x, y]: [f64; 2]) -> [f64; 2] {
    [x - 0.5 * x * y, -0.8 * y + 0.4 * x * y]
}

/// States with noise `sigma`, and their rates, the first with an offset of `bias`.
fn table(sigma: f64, bias: f64) -> String {
    let mut random = Random::new(11);
    let (mut z, h) = ([1.0, 1.0], STEP / 8.0);
    let mut text = String::from("t,x,y,dx,dy\n");
    for row in 0..ROWS {
        let [dx, dy] = law(z);
        let mut read = |v: f64| v + sigma * random.normal();
        let (x, y, dx, dy) = (read(z[0]), read(z[1]), read(dx) + bias, read(dy));
        text.push_str(&format!("{},{x},{y},{dx},{dy}\n", row as f64 * STEP));
        for _ in 0..8 {
            let ahead = |k: [f64; 2], h: f64| law([z[0] + h * k[0], z[1] + h * k[1]]);
            let a = law(z);
            let b = ahead(a, 0.5 * h);
            let c = ahead(b, 0.5 * h);
            let d = ahead(c, h);
            let sum = |i: usize| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0;
            z = [z[0] + h * sum(0), z[1] + h * sum(1)];
        }
    }
    text
}

const MODEL: &str = "state x, y\ndx, dy ~ poly(x, y; 2)\n";

fn identify(folder: &Path, sigma: f64, more: &[&str]) -> (Run, Value) {
    identified(folder, MODEL, table(sigma, 0.3), more)
}

fn identified(folder: &Path, model: &str, table: String, more: &[&str]) -> (Run, Value) {
    let paths = [("m.sid", model.to_string()), ("run.csv", table)];
    let paths = paths.map(|(name, text)| {
        let path = folder.join(name);
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_string()
    });
    let run = sidc(&[&["identify", &paths[0], &paths[1], "--json"][..], more].concat());
    let document = serde_json::from_str(&run.stdout).unwrap();
    (run, document)
}

fn ways(document: &Value) -> &Value {
    &document["equations"][0]["evidence"]["ways"]
}

#[test]
fn where_regression_is_doubted_the_joint_estimate_is_given() {
    let folder = tempfile::tempdir().unwrap();
    let (run, document) = identify(folder.path(), 0.005, &[]);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    assert!(run.stderr.contains("warning[other-way]"), "{}", run.stderr);
    let terms = document["equations"][0]["terms"].as_array().unwrap();
    let terms: Vec<&str> = terms.iter().filter_map(|t| t["term"].as_str()).collect();
    assert_eq!(terms, ["x", "x*y"]);
    let ways = ways(&document);
    assert_eq!(ways["first"], "regression");
    assert_eq!(ways["second"], "joint");
    assert_eq!(ways["given"], "joint");
    let codes = ways["first_doubts"].as_array().unwrap();
    assert!(codes.iter().any(|c| c == "rate-disagrees"), "{codes:?}");
    assert!(ways["second_doubts"].is_null());
    let warnings = document["warnings"].as_array().unwrap();
    let told = warnings.iter().find(|w| w["code"] == "other-way").unwrap();
    let text = told["text"].as_str().unwrap();
    for named in ["regression", "rate-disagrees", "joint"] {
        assert!(text.contains(named), "{text}");
    }
}

#[test]
fn a_way_that_was_asked_for_is_the_only_one() {
    let folder = tempfile::tempdir().unwrap();
    let (run, document) = identify(folder.path(), 0.005, &["--method", "regression"]);
    assert_eq!(run.status, 3, "{}", run.stderr);
    assert!(ways(&document).is_null());
    assert!(!run.stderr.contains("other-way"), "{}", run.stderr);
}

/// A library without x*y leaves motion unexplained, also in a trajectory.
#[test]
fn a_library_that_leaves_motion_has_one_way() {
    let folder = tempfile::tempdir().unwrap();
    let model = "state x, y\ndx, dy ~ <x, y>\n";
    let (run, document) = identified(folder.path(), model, table(0.005, 0.0), &[]);
    assert_eq!(run.status, 3, "{}", run.stderr);
    assert!(ways(&document).is_null());
    assert!(run.stdout.contains("x*y"), "{}", run.stdout);
}

/// Half of the rates is noise, which is not a fault of the library.
#[test]
fn rates_that_are_mostly_noise_have_two_ways() {
    let folder = tempfile::tempdir().unwrap();
    let (run, document) = identified(folder.path(), MODEL, table(0.3, 0.0), &[]);
    let first = ways(&document)["first_doubts"].as_array();
    let first = first.unwrap_or_else(|| panic!("{}{}", run.stdout, run.stderr));
    assert!(first.iter().any(|c| c == "poor-fit"), "{first:?}");
}

/// Without noise, the likelihood of the readings cannot distinguish a law from a close approximation; regression can.
#[test]
fn clean_records_have_one_way() {
    let folder = tempfile::tempdir().unwrap();
    let (run, document) = identify(folder.path(), 0.0, &[]);
    assert_eq!(run.status, 3, "{}", run.stderr);
    assert!(ways(&document).is_null());
}

/// If sixty seconds at rest follow one second of motion, a smoother takes the motion for noise; differences do not.
#[test]
fn exact_records_that_come_to_rest_are_clean() {
    let folder = tempfile::tempdir().unwrap();
    let row = |k: i32| {
        let t = 0.1 * f64::from(k);
        format!("{t},{}\n", (-0.7 * t).exp())
    };
    let table: String = std::iter::once("t,x\n".into())
        .chain((0..600).map(row))
        .collect();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_string()
    };
    let model = write("m.sid", "state x\ndx ~ poly(x; 3)\n");
    let run = sidc(&["identify", &model, &write("run.csv", &table), "--evidence"]);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    assert!(run.stdout.contains("dx = -0.7*x"), "{}", run.stdout);
    assert!(run.stdout.contains("proved"), "{}", run.stdout);
}

/// A body that flies freely at a speed of 1 between two springs with eigenfrequency 8, each 0.5 from the centre: its positions, exact.
fn between_springs() -> String {
    let half = 1.0 + std::f64::consts::PI / 8.0;
    let place = |t: f64| {
        let within = t % half;
        let place = match within < 1.0 {
            true => within - 0.5,
            false => 0.5 + (8.0 * (within - 1.0)).sin() / 8.0,
        };
        match (t / half) as usize % 2 {
            0 => place,
            _ => -place,
        }
    };
    let row = |k: usize| format!("{},{}\n", 0.02 * k as f64, place(0.02 * k as f64));
    std::iter::once("t,x\n".into())
        .chain((0..400).map(row))
        .collect()
}

/// Estimated derivatives are blurred where the force bends; a trajectory that goes from event to event is not.
#[test]
fn exact_records_of_laws_that_bend_are_estimated_jointly() {
    let folder = tempfile::tempdir().unwrap();
    let model = "state x : order 2\nddx ~ <1, x, dx, x^3, max(x - 0.5, 0) + min(x + 0.5, 0)>\n";
    let (run, document) = identified(folder.path(), model, between_springs(), &[]);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    assert_eq!(ways(&document)["given"], "joint");
    let terms = document["equations"][0]["terms"].as_array().unwrap();
    assert_eq!(terms.len(), 1, "{terms:?}");
    let stiffness = terms[0]["coefficient"].as_f64().unwrap();
    assert!((stiffness + 64.0).abs() < 1e-5, "{stiffness}");
}
