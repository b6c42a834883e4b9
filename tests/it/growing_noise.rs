//! Noise that grows with the signal, declared or found.

use std::path::Path;

use sidc_testing::integrate::integrate;
use sidc_testing::program::{Run, sidc};
use sidc_testing::random::Random;

const MODEL: &str = "state x, y\ndx, dy ~ poly(x, y; 2)\n";
const TRUTH: [&[(&str, f64)]; 2] = [&[("x", 1.1), ("x*y", -0.4)], &[("y", -0.4), ("x*y", 0.1)]];

/// Lotka–Volterra's predator and prey, 301 samples.
fn populations() -> Vec<[f64; 2]> {
    let law = |_: f64, z: &[f64; 2]| {
        let [x, y] = *z;
        [1.1 * x - 0.4 * x * y, -0.4 * y + 0.1 * x * y]
    };
    let mut z = [10.0, 5.0];
    let mut out = vec![z];
    for k in 0..300 {
        z = integrate(&law, f64::from(k) * 0.1, f64::from(k + 1) * 0.1, z);
        out.push(z);
    }
    out
}

/// Readings with noise of standard deviation √(`floor`² + (`share` · value)²).
fn read(floor: f64, share: f64, seed: u64) -> Vec<[f64; 2]> {
    let mut random = Random::new(seed);
    let mut noisy = |x: f64| x + floor.hypot(share * x) * random.normal();
    populations()
        .into_iter()
        .map(|z| z.map(&mut noisy))
        .collect()
}

fn table(readings: &[[f64; 2]]) -> String {
    let rows = (0..).zip(readings);
    let rows = rows.map(|(k, [x, y])| format!("{},{x},{y}\n", 0.1 * f64::from(k)));
    format!("t,x,y\n{}", rows.collect::<String>())
}

fn identify(model: &str, readings: &[[f64; 2]], more: &[&str]) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let write = |name: &str, text: &str| std::fs::write(Path::new(&path(name)), text).unwrap();
    write("m.sid", model);
    write("d.csv", &table(readings));
    sidc(&[&["identify", "-q", &path("m.sid"), &path("d.csv")], more].concat())
}

fn document(model: &str, readings: &[[f64; 2]], more: &[&str]) -> serde_json::Value {
    let run = identify(model, readings, &[more, &["--json"]].concat());
    serde_json::from_str(&run.stdout).unwrap_or_else(|e| panic!("{e}: {}", run.stderr))
}

/// Coefficients with their intervals, if the terms are the true ones.
fn coefficients(document: &serde_json::Value) -> Option<Vec<(f64, f64, [f64; 2])>> {
    let mut out = Vec::new();
    for (equation, truth) in document["equations"].as_array()?.iter().zip(TRUTH) {
        let terms = equation["terms"].as_array()?;
        if terms.len() != truth.len() {
            return None;
        }
        for (name, value) in truth {
            let term = terms.iter().find(|t| t["term"] == *name)?;
            let end = |i: usize| term["interval"][i].as_f64();
            out.push((*value, term["coefficient"].as_f64()?, [end(0)?, end(1)?]));
        }
    }
    Some(out)
}

/// Floor and share of each channel's noise.
fn growth(document: &serde_json::Value) -> Vec<Option<(f64, f64)>> {
    let equations = document["equations"].as_array().unwrap().iter();
    let channel = |e: &serde_json::Value| {
        let growing = &e["evidence"]["together"]["channels"][0]["growing"];
        Some((growing["floor"].as_f64()?, growing["share"].as_f64()?))
    };
    equations.map(channel).collect()
}

#[test]
fn growth_is_found_and_intervals_hold_the_truth() {
    let (mut inside, mut all) = (0, 0);
    for seed in 0..6 {
        let found = document(MODEL, &read(0.0, 0.05, seed), &[]);
        for (truth, _, [low, high]) in coefficients(&found).expect("the true terms") {
            inside += usize::from((low..=high).contains(&truth));
            all += 1;
        }
        for (floor, share) in growth(&found).into_iter().map(Option::unwrap) {
            assert!((0.043..0.057).contains(&share), "{share}");
            assert!(floor < 0.1, "{floor}");
        }
    }
    // 24 intervals of 95 %: the chance of fewer than 20 hits is 1 %.
    assert!(inside >= 20, "{inside} of {all}");
}

#[test]
fn declared_noise_gives_what_is_found() {
    let readings = read(0.02, 0.1, 3);
    let found = coefficients(&document(MODEL, &readings, &[])).expect("the true terms");
    let declared = "state x, y : noise 0.02 + 10%\ndx, dy ~ poly(x, y; 2)\n";
    let said = document(declared, &readings, &[]);
    for (a, b) in found
        .iter()
        .zip(coefficients(&said).expect("the true terms"))
    {
        let width = b.2[1] - b.2[0];
        assert!((a.1 - b.1).abs() < 0.25 * width, "{a:?} {b:?}");
    }
    // Options give the same result as declarations, to the last digit.
    let options = ["--noise", "x=0.02+10%", "--noise", "y=0.02+10%"];
    let (a, b) = (
        identify(declared, &readings, &[]),
        identify(MODEL, &readings, &options),
    );
    let equations = |run: &Run| run.stdout.split("\nlaw:").next().map(str::to_string);
    assert_eq!(equations(&a), equations(&b));
}

#[test]
fn noise_that_does_not_grow_is_not_said_to() {
    for seed in 0..4 {
        let found = document(MODEL, &read(0.2, 0.0, seed), &[]);
        assert_eq!(growth(&found), [None, None]);
    }
}

#[test]
fn a_reading_far_off_where_noise_is_small_is_an_outlier() {
    let mut readings = read(0.0, 0.05, 1);
    let least = (1..300).min_by(|a, b| readings[*a][0].total_cmp(&readings[*b][0]));
    // An outlier compared with noise of 0.03 here, though below the noise of the largest readings.
    readings[least.unwrap()][0] += 0.4;
    let run = identify(
        MODEL,
        &readings,
        &[
            "--noise",
            "x=5%",
            "--noise",
            "y=5%",
            "--robust",
            "--evidence",
        ],
    );
    assert!(
        run.stdout.contains("robust: 1 readings of x had no weight"),
        "{}",
        run.stdout
    );
    assert!(run.stdout.contains("noise of x grows"), "{}", run.stdout);
}

#[test]
fn rounding_of_an_encoder_is_part_of_the_noise() {
    let round = |z: [f64; 2]| z.map(|x| (x / 0.2).round() * 0.2);
    let readings: Vec<[f64; 2]> = read(0.0, 0.03, 2).into_iter().map(round).collect();
    let found = document(MODEL, &readings, &["--noise", "x=3%", "--noise", "y=3%"]);
    assert!(coefficients(&found).is_some(), "{found}");
    for (floor, share) in growth(&found).into_iter().map(Option::unwrap) {
        let rounding = 0.2 / 12_f64.sqrt();
        assert!((0.7..1.4).contains(&(floor / rounding)), "{floor}");
        assert!((0.02..0.04).contains(&share), "{share}");
    }
}

#[test]
fn growth_is_said() {
    let run = identify(MODEL, &read(0.05, 0.05, 5), &["--evidence"]);
    let line = run.stdout.lines().find(|l| l.contains("grows")).unwrap();
    insta::assert_snapshot!("growth_is_said", line.trim());
}

#[test]
fn the_weak_form_says_that_it_does_not_use_a_share() {
    let options = ["--method", "weak", "--noise", "y=5%"];
    let run = identify(MODEL, &read(0.0, 0.05, 1), &options);
    insta::assert_snapshot!("share_unused", run.stderr);
}

#[test]
fn a_noise_that_is_none_is_refused() {
    for wrong in ["x=-5%", "x=0", "x=2%+3%", "x=%", "x=0.1+", "x"] {
        let run = identify(MODEL, &read(0.1, 0.0, 1), &["--noise", wrong]);
        assert_eq!(run.status, 2, "{wrong}: {}", run.stderr);
        assert!(run.stderr.contains("a noise"), "{}", run.stderr);
    }
}
