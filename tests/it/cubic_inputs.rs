//! Inputs along cubics between their samples: found or declared, and followed by runs. The system is driven by sines, so that its motion is known in
//! closed form.

use std::fs;
use std::path::Path;

use serde_json::Value;
use sidc_testing::integrate::{grid, integrate};
use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::sidc_in;

const STEP: f64 = 0.15;
const ROWS: usize = 400;
const NOISE: f64 = 1e-4;
/// Amplitude, frequency and phase of each sine. The fastest has eight samples a period.
const SINES: [[f64; 3]; 3] = [[1.0, 0.7, 0.3], [0.8, 2.9, 1.1], [0.6, 5.2, 2.0]];

/// Input, position and rate of ddx = −4 x − 0.4 dx + u in the steady state.
fn motion(t: f64) -> [f64; 3] {
    let mut all = [0.0; 3];
    for [amplitude, w, phase] in SINES {
        let (stiff, damped) = (4.0 - w * w, 0.4 * w);
        let gain = amplitude / stiff.hypot(damped);
        let late = damped.atan2(stiff);
        all[0] += amplitude * (w * t + phase).sin();
        all[1] += gain * (w * t + phase - late).sin();
        all[2] += gain * w * (w * t + phase - late).cos();
    }
    all
}

fn record() -> String {
    let mut random = Random::new(3);
    let row = |k: usize| {
        let t = k as f64 * STEP;
        let [u, x, _] = motion(t);
        format!("{t},{},{u}\n", x + NOISE * random.normal())
    };
    let rows: String = (0..ROWS).map(row).collect();
    format!("t,x,u\n{rows}")
}

/// The printed answer and the document.
fn identify(folder: &Path, between: &str) -> (String, Value) {
    let model = format!("state x : order 2\ninput u : {between}\nddx ~ poly(x, dx, u; 2)\n");
    fs::write(folder.join("m.sid"), model).unwrap();
    fs::write(folder.join("a.csv"), record()).unwrap();
    let run = sidc_in(
        folder,
        &["identify", "m.sid", "a.csv", "-q", "-o", "r.json"],
    );
    let document = fs::read_to_string(folder.join("r.json")).unwrap();
    (run.stdout, serde_json::from_str(&document).unwrap())
}

fn has_the_law(document: &Value) {
    let terms = document["equations"][0]["terms"].as_array().unwrap();
    let wanted = [("x", -4.0), ("dx", -0.4), ("u", 1.0)];
    assert_eq!(terms.len(), wanted.len(), "{terms:?}");
    for (name, wanted) in wanted {
        let term = terms.iter().find(|t| t["term"] == name).unwrap();
        let found = term["coefficient"].as_f64().unwrap();
        assert!((found - wanted).abs() < 2e-3, "{name}: {found}");
    }
}

/// The largest error of a run of the document from the true start.
fn error_of_run(folder: &Path) -> f64 {
    let [_, x, dx] = motion(0.0);
    let start = format!("x={x},dx={dx}");
    let args = [
        "simulate", "r.json", "a.csv", "-q", "-o", "run.csv", "--start", &start,
    ];
    let run = sidc_in(folder, &args);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    let text = fs::read_to_string(folder.join("run.csv")).unwrap();
    let head: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|h| *h == name).unwrap();
    let (t, x) = (column("t"), column("x"));
    let rows = text.lines().skip(1).map(|line| {
        let cells: Vec<f64> = line
            .split(',')
            .map(|c| c.parse().unwrap_or(f64::NAN))
            .collect();
        (cells[x] - motion(cells[t])[1]).abs()
    });
    rows.fold(0.0, f64::max)
}

#[test]
fn an_input_that_is_found_to_run_along_cubics_does_so_in_runs() {
    let folder = tempfile::tempdir().unwrap();
    let (printed, mut document) = identify(folder.path(), "linear");
    has_the_law(&document);
    assert!(
        printed.contains("u runs along cubics between its samples"),
        "{printed}"
    );
    let along_cubics = error_of_run(folder.path());
    let evidence = &mut document["equations"][0]["evidence"]["together"];
    assert_eq!(evidence["cubic"], serde_json::json!(["u"]));
    evidence["cubic"] = serde_json::json!([]);
    fs::write(folder.path().join("r.json"), document.to_string()).unwrap();
    let straight = error_of_run(folder.path());
    assert!(
        along_cubics < 1e-3 && straight > 5.0 * along_cubics,
        "{along_cubics} {straight}"
    );
}

#[test]
fn an_input_that_is_declared_cubic_runs_so_from_the_start() {
    let folder = tempfile::tempdir().unwrap();
    let (printed, document) = identify(folder.path(), "cubic");
    has_the_law(&document);
    assert!(!printed.contains("along cubics"), "{printed}");
    assert_eq!(document["settings"]["reading"]["between"]["u"], "cubic");
    assert!(error_of_run(folder.path()) < 2e-3);
}

#[test]
fn the_acceleration_of_an_input_is_taken_from_its_readings() {
    // A pendulum whose pivot is moved: only positions are read.
    let pivot = |t: f64| {
        let sine = |a: f64, w: f64, p: f64| [a * (w * t + p).sin(), -a * w * w * (w * t + p).sin()];
        let (slow, fast) = (sine(0.1, 3.0, 0.0), sine(0.06, 5.2, 1.0));
        [slow[0] + fast[0], slow[1] + fast[1]]
    };
    let law = |t: f64, &[angle, rate]: &[f64; 2]| {
        let pushed = pivot(t)[1] * angle.cos();
        [rate, -9.81 * angle.sin() - 0.3 * rate - pushed]
    };
    let (mut random, mut state) = (Random::new(4), [0.5, 0.0]);
    let mut text = String::from("t,th,p\n");
    for t in grid(800, 0.02) {
        let read = state[0] + 0.003 * random.normal();
        text += &format!("{t},{read},{}\n", pivot(t)[0]);
        state = integrate(&law, t, t + 0.02, state);
    }
    let folder = tempfile::tempdir().unwrap();
    let model = "state th : order 2\ninput p : cubic, order 2\n\
        ddth ~ <1, th, dth, sin th, cos th, dp*cos th, ddp*cos th, ddp>\n";
    fs::write(folder.path().join("m.sid"), model).unwrap();
    fs::write(folder.path().join("a.csv"), text).unwrap();
    let arguments = ["identify", "m.sid", "a.csv", "-o", "r.json"];
    let run = sidc_in(folder.path(), &arguments);
    let passes = run.stdout.contains("law: passes");
    assert!(
        passes && run.stderr.is_empty(),
        "{}{}",
        run.stdout,
        run.stderr
    );
    let document = fs::read_to_string(folder.path().join("r.json")).unwrap();
    let document: Value = serde_json::from_str(&document).unwrap();
    let terms = document["equations"][0]["terms"].as_array().unwrap();
    let wanted = [("sin(th)", -9.81), ("dth", -0.3), ("ddp*cos(th)", -1.0)];
    assert_eq!(terms.len(), wanted.len(), "{}", run.stdout);
    for (name, wanted) in wanted {
        let term = terms.iter().find(|t| t["term"] == name).unwrap();
        let found = term["coefficient"].as_f64().unwrap();
        assert!((found / wanted - 1.0).abs() < 0.03, "{}", run.stdout);
    }
}
