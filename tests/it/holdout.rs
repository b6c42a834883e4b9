//! Data held out, and several models for the same data.

use std::path::Path;

use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, sidc};

const LORENZ: [&str; 2] = ["models/lorenz.sid", "models/data/lorenz.csv"];
const PENDULUM: [&str; 2] = ["models/pendulum.sid", "models/data/pendulum.csv"];

fn identify(args: &[&str]) -> Run {
    sidc(&[&["identify", "-q"], args].concat())
}

fn json(args: &[&str]) -> serde_json::Value {
    let run = identify(&[args, &["--json"]].concat());
    serde_json::from_str(&run.stdout).unwrap_or_else(|e| panic!("{e}: {}", run.stderr))
}

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

/// (held out, record, from, to, worst error relative to the signal) of every free run.
fn runs(document: &serde_json::Value) -> Vec<(bool, String, f64, f64, f64)> {
    let runs = document["validation"]["runs"].as_array().unwrap();
    let worst = |r: &serde_json::Value| {
        let scores = r["scores"].as_array().unwrap().iter();
        let errors = scores.map(|s| s["error_to_signal_db"].as_f64().unwrap());
        errors.fold(f64::NEG_INFINITY, f64::max)
    };
    let run = |r: &serde_json::Value| {
        let number = |key: &str| r[key].as_f64().unwrap();
        let record = r["record"].as_str().unwrap().to_string();
        let held = r["held_out"].as_bool().unwrap();
        (held, record, number("from"), number("to"), worst(r))
    };
    runs.iter().map(run).collect()
}

#[test]
fn a_stretch_held_out_is_simulated_and_not_used() {
    let document = json(&[&PENDULUM[..], &["--holdout=6..10"]].concat());
    let runs = runs(&document);
    let places: Vec<(bool, f64, f64)> = runs.iter().map(|r| (r.0, r.2, r.3)).collect();
    let expected = [(false, 0.0, 5.96), (false, 10.04, 15.96), (true, 6.0, 10.0)];
    assert_eq!(places.len(), 3);
    for (got, want) in places.iter().zip(expected) {
        assert_eq!(got.0, want.0);
        assert!(
            (got.1 - want.1).abs() < 1e-9 && (got.2 - want.2).abs() < 1e-9,
            "{got:?}"
        );
    }
    assert!(runs.iter().all(|r| r.4 < -100.0), "{runs:?}");
    assert_eq!(document["equations"][0]["evidence"]["rows"], 299);
    assert_eq!(document["settings"]["holdout"][0], "6..10");
}

#[test]
fn a_whole_file_is_held_out() {
    let held = "models/data/sir_b.csv";
    let document = json(&["models/sir.sid", "models/data/sir_a.csv", "--holdout", held]);
    let runs = runs(&document);
    let records: Vec<(bool, &str)> = runs.iter().map(|r| (r.0, r.1.as_str())).collect();
    assert_eq!(records, [(false, "sir_a.csv"), (true, "sir_b.csv")]);
    assert!(runs[1].4 < -60.0, "{runs:?}");
    // A file named twice counts once.
    let twice = [
        "models/sir.sid",
        "models/data/sir_a.csv",
        held,
        "--holdout",
        held,
    ];
    let both = json(&twice);
    assert_eq!(both["validation"], document["validation"]);
}

#[test]
fn a_wrong_law_fails_where_it_was_not_found() {
    let folder = tempfile::tempdir().unwrap();
    let narrow = write(
        folder.path(),
        "narrow.sid",
        "state x, y, z\ndx, dy, dz ~ poly(x, y, z; 1)\n",
    );
    let document = json(&[&narrow, LORENZ[1], "--holdout=25%"]);
    let runs = runs(&document);
    assert!(runs[1].0 && runs[1].4 > -20.0, "{runs:?}");
}

#[test]
fn the_smallest_of_equal_models_is_best() {
    let folder = tempfile::tempdir().unwrap();
    let model = |name: &str, degree: u32| {
        let text = format!("state x, y, z\ndx, dy, dz ~ poly(x, y, z; {degree})\n");
        write(folder.path(), name, &text)
    };
    let (one, two, three) = (
        model("one.sid", 1),
        model("two.sid", 2),
        model("three.sid", 3),
    );
    let run = identify(&[&one, &two, &three, LORENZ[1]]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    let table: Vec<&str> = run.stdout.lines().take_while(|l| !l.is_empty()).collect();
    insta::assert_snapshot!(masked(&table));
    assert!(run.stdout.contains("dx = -10*x + 10*y\n"));

    let document = json(&[&one, &two, &three, LORENZ[1], "--until=-40"]);
    let candidates = document["candidates"].as_array().unwrap();
    let tried: Vec<&str> = candidates
        .iter()
        .map(|c| c["model"].as_str().unwrap())
        .collect();
    assert_eq!(tried, ["two.sid", "one.sid"], "the third is not tried");
    assert_eq!(document["settings"]["model"], "two.sid");
    assert_eq!(candidates[0]["best"], true);
}

/// Masks figures far below the noise of any record, which depend on rounding.
fn masked(table: &[&str]) -> String {
    let line = |l: &&str| {
        let words: Vec<String> = l
            .split(' ')
            .map(|w| match w.parse::<f64>() {
                Ok(x) if x < -100.0 => "(exact)".into(),
                _ => w.to_string(),
            })
            .collect();
        words.join(" ") + "\n"
    };
    table.iter().map(line).collect()
}

#[test]
fn what_cannot_be_held_out_is_said() {
    let refuses = |more: &[&str], status: i32, words: &[&str]| {
        let run = identify(&[&LORENZ[..], more].concat());
        assert_eq!(
            (run.status, run.stdout.as_str()),
            (status, ""),
            "{}",
            run.stderr
        );
        for word in words {
            assert!(
                run.stderr.contains(word),
                "`{word}` not in:\n{}",
                run.stderr
            );
        }
    };
    refuses(
        &["--holdout=20..30"],
        1,
        &["empty-holdout", "t = 0 to t = 9.99"],
    );
    refuses(&["--holdout=.."], 1, &["nothing-left", "shorter stretch"]);
    refuses(&["--holdout=absent.csv"], 2, &["A..B", "25%", "data file"]);
    refuses(&["--holdout=0%"], 2, &["above 0 %"]);
    refuses(&["--holdout=5..4"], 2, &["5 is not before 4"]);
    refuses(&["--until=soon"], 2, &["-60"]);
}

#[test]
fn faults_of_all_models_are_told_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let a = write(folder.path(), "a.sid", "state x\ndx ~ poly(x; 2) + zz\n");
    let b = write(folder.path(), "b.sid", "state x\ndx ~ poly(q; 2)\n");
    let run = identify(&[&a, &b, LORENZ[1]]);
    assert_eq!(run.status, 1);
    assert!(
        run.stderr.contains("`zz`") && run.stderr.contains("`q`"),
        "{}",
        run.stderr
    );
}

/// The rate constants of the two files differ.
#[test]
fn what_does_not_carry_over_is_a_doubt() {
    let folder = tempfile::tempdir().unwrap();
    let decay = |rate: f64| {
        let row = |i: i32| {
            format!(
                "{},{:.15e}\n",
                0.1 * f64::from(i),
                (-0.1 * rate * f64::from(i)).exp()
            )
        };
        format!("t,x\n{}", (0..50).map(row).collect::<String>())
    };
    let model = write(folder.path(), "m.sid", "state x\ndx ~ poly(x; 3)\n");
    let [slow, fast, same] = [("slow.csv", 0.5), ("fast.csv", 2.0), ("same.csv", 0.5)]
        .map(|(name, rate)| write(folder.path(), name, &decay(rate)));
    let run = identify(&[&model, &slow, "--holdout", &same]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    let run = identify(&[&model, &slow, "--holdout", &fast]);
    assert_eq!(run.status, 3, "{}", run.stdout);
    assert!(
        run.stdout.contains("along fast.csv, which was held out"),
        "{}",
        run.stdout
    );
    let document = json(&[&model, &slow, "--holdout", &fast]);
    assert_eq!(
        document["equations"][0]["reasons"][0]["code"],
        "not-carried-over"
    );
}

/// Between impacts a ball falls freely, and the equation covers only that, so its run goes through the floor.
#[test]
fn a_run_that_leaves_the_data_is_a_doubt() {
    let folder = tempfile::tempdir().unwrap();
    let (mut x, mut v) = (2.0, 0.0);
    let mut table = String::from("t,h\n");
    for i in 0..=300 {
        table.push_str(&format!("{:.2},{x:?}\n", 0.01 * f64::from(i)));
        (x, v) = (x + 0.01 * v - 9.81 * 0.00005, v - 0.0981);
        if x < 0.0 {
            (x, v) = (-0.8 * x, -0.8 * v);
        }
    }
    let model = write(
        folder.path(),
        "m.sid",
        "state h : order 2\nddh ~ poly(h, dh; 3)\n",
    );
    let data = write(folder.path(), "ball.csv", &table);
    let run = identify(&[&model, &data, "--holdout=25%"]);
    assert_eq!(run.status, 3, "{}", run.stdout);
    assert!(
        run.stdout.contains("leaves what was measured of h"),
        "{}",
        run.stdout
    );
}

/// In the held-out part the motion has decayed to noise; missing that is not a fault of the equation.
#[test]
fn a_motion_that_has_died_down_is_no_doubt() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random::new(4);
    for noise in [0.0, 0.003, 0.02] {
        let mut table = String::from("t,x\n");
        for k in 0..600 {
            let t = 0.02 * f64::from(k);
            let x = (-0.9 * t).exp() * (4.0 * t).cos() + noise * random.normal();
            table.push_str(&format!("{t:.2},{x:.12}\n"));
        }
        let model = write(
            folder.path(),
            "m.sid",
            "state x : order 2\nddx ~ <x, dx, x^2>\n",
        );
        let data = write(folder.path(), "d.csv", &table);
        let run = identify(&[&model, &data, "--holdout=25%"]);
        assert!(
            !run.stdout.contains("doubt[not-carried-over]"),
            "{}",
            run.stdout
        );
        assert!(
            !run.stdout.contains("doubt[run-leaves-data]"),
            "{}",
            run.stdout
        );
    }
}
