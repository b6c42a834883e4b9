//! Constants inside terms that differ from run to run: one law, a value for each run, and outputs with the run's own value.

use std::fs;
use std::path::Path;

use crate::unknown_constants::{table, terms};
use serde_json::Value;
use sidc_testing::program::{Run, sidc_in};
use sidc_testing::random::Random;

/// Identifies one model from several runs in a folder.
fn identify(folder: &Path, model: &str, runs: &[String]) -> (Run, Value) {
    fs::write(folder.join("m.sid"), model).unwrap();
    let names: Vec<String> = (0..runs.len()).map(|k| format!("{k}.csv")).collect();
    for (name, text) in names.iter().zip(runs) {
        fs::write(folder.join(name), text).unwrap();
    }
    let mut args = vec!["identify", "m.sid"];
    args.extend(names.iter().map(String::as_str));
    args.extend(["-o", "r.json"]);
    let run = sidc_in(folder, &args);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    let found = fs::read_to_string(folder.join("r.json")).unwrap();
    (run, serde_json::from_str(&found).unwrap())
}

/// Number of values in their intervals, and the largest relative error.
fn compare(found: &Value, truth: &[f64]) -> (usize, f64) {
    let all = found["unknowns"].as_array().unwrap();
    assert_eq!(all.len(), truth.len(), "{all:?}");
    let (mut within, mut worst) = (0, 0.0_f64);
    for (k, (one, truth)) in all.iter().zip(truth).enumerate() {
        assert_eq!(one["run"], format!("{k}.csv"));
        let off = (one["value"].as_f64().unwrap() - truth).abs();
        let half = 1.96 * one["standard_error"].as_f64().unwrap_or_default();
        within += usize::from(off <= half.max(1e-6));
        worst = worst.max(off / truth);
    }
    (within, worst)
}

fn feed(t: f64, phase: f64) -> f64 {
    0.5 + 0.4 * (0.7 * t + phase).sin() + 0.3 * (1.9 * t + 2.0 * phase).sin()
}

/// Saturating uptake with maximum 1.5 and this half-saturation concentration, read with this noise.
fn uptake(half: f64, phase: f64, noise: f64, random: &mut Random) -> String {
    let law = |t: f64, x: &[f64; 1]| [feed(t, phase) - 1.5 * x[0] / (half + x[0])];
    table("x,u", 200, [2.0], &law, |t, x| {
        vec![x[0] + noise * random.normal(), feed(t, phase)]
    })
}

const UPTAKE: &str = "unknown K in 0.01 .. 10 : per run\nstate x\ninput u : linear\ndx ~ <1, x, x^2, u, u*x, x/(K + x), 1/(K + x)>\n";

#[test]
fn batches_share_a_law_and_have_a_half_saturation_each() {
    let truth: Vec<f64> = (0..10).map(|k| 0.4 + 0.12 * f64::from(k)).collect();
    for (noise, worst_allowed) in [(0.0, 1e-5), (0.03, 0.05)] {
        let mut random = Random::new(7);
        let folder = tempfile::tempdir().unwrap();
        let runs = truth.iter().enumerate();
        let runs: Vec<String> = runs
            .map(|(k, half)| uptake(*half, k as f64, noise, &mut random))
            .collect();
        let (run, found) = identify(folder.path(), UPTAKE, &runs);
        let names: Vec<&str> = terms(&found).iter().map(|t| t.0).collect();
        assert_eq!(names, ["u", "x/(K + x)"], "{}", run.stdout);
        let (within, worst) = compare(&found, &truth);
        assert!(
            within >= 8 && worst < worst_allowed,
            "{within} {worst} {}",
            run.stdout
        );
    }
}

#[test]
fn every_output_takes_the_value_of_the_run() {
    let truth = [0.3, 0.9, 2.5];
    let mut random = Random::new(1);
    let folder = tempfile::tempdir().unwrap();
    let runs = truth.map(|half| uptake(half, half, 0.0, &mut random));
    let (run, _) = identify(folder.path(), UPTAKE, &runs);
    assert!(run.stdout.contains(" in 0.csv, "), "{}", run.stdout);
    for (name, own) in [("0.csv", "    K = 0.3"), ("2.csv", "    K = 2.5")] {
        let run = sidc_in(folder.path(), &["simulate", "r.json", name]);
        assert!(run.stdout.contains(own), "{}{}", run.stdout, run.stderr);
        assert!(
            run.stdout.contains("1.0000"),
            "{}{}",
            run.stdout,
            run.stderr
        );
        assert!(
            run.stdout.contains("100.00 %") || run.stdout.contains("99.9"),
            "{}",
            run.stdout
        );
    }
    let code = sidc_in(folder.path(), &["export", "r.json", "--to", "python"]).stdout;
    let mean = code.split("SIDC_CONSTANTS = (\n    ").nth(1).unwrap();
    let mean: f64 = mean.split(',').next().unwrap().parse().unwrap();
    assert!(
        (mean - truth.iter().sum::<f64>() / 3.0).abs() < 1e-3,
        "{code}"
    );
    assert!(code.contains("the mean of its runs"), "{code}");
    let report = [
        "report", "r.json", "0.csv", "1.csv", "2.csv", "-o", "r.html",
    ];
    let report = sidc_in(folder.path(), &report);
    assert_eq!(report.status, 0, "{}", report.stderr);
    let page = fs::read_to_string(folder.path().join("r.html")).unwrap();
    assert!(page.contains("the mean of its runs"));
}

/// With fixed gravity. Under noise, terms selected at fixed lengths would compensate for errors of the lengths.
#[test]
fn pendulums_of_unknown_lengths_share_their_friction() {
    let model = "unknown L in 0.1 .. 10, per run\nstate th : order 2\nddth ~ known(-9.81*sin(th)/L) + <1, th, dth, dth^2, cos(th), dth^3>\n";
    let truth: Vec<f64> = (0..10).map(|k| 0.5 + 0.15 * f64::from(k)).collect();
    for (noise, worst_allowed) in [(0.0, 1e-5), (0.02, 0.01)] {
        let mut random = Random::new(3);
        let folder = tempfile::tempdir().unwrap();
        let runs = truth.iter().map(|length| {
            let law = |_: f64, x: &[f64; 2]| [x[1], -9.81 / length * x[0].sin() - 0.2 * x[1]];
            let read = |_: f64, x: &[f64; 2]| vec![x[0] + noise * random.normal()];
            table("th", 150, [1.0 + length, 0.0], &law, read)
        });
        let runs: Vec<String> = runs.collect();
        let (run, found) = identify(folder.path(), model, &runs);
        let names: Vec<&str> = terms(&found).iter().map(|t| t.0).collect();
        assert_eq!(names, ["sin(th)/L", "dth"], "{}", run.stdout);
        let (within, worst) = compare(&found, &truth);
        assert!(
            within >= 8 && worst < worst_allowed,
            "{within} {worst} {}",
            run.stdout
        );
    }
}
