//! Several runs of one plant estimated jointly: with different lengths, steps and starts, with a bad one, side by side or stacked in a file, with
//! coefficients that differ.

use std::fs;
use std::path::Path;

use serde_json::Value;
use sidc_testing::integrate::{grid, integrate};
use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, sidc_in};

const MODEL: &str = "state x : order 2\ninput u : hold\nddx ~ poly(x, dx; 2) + u\n";

/// A mass on a spring under held levels of force, read with noise of 0.01: t, x, u.
struct Record {
    mass: f64,
    step: f64,
    rows: usize,
    from: f64,
    seed: u64,
}

impl Record {
    fn columns(&self) -> [Vec<f64>; 3] {
        let mut random = Random::new(self.seed);
        let hold = (0.7 / self.step) as usize;
        let levels: Vec<f64> = (0..=self.rows / hold)
            .map(|_| 4.0 * random.uniform() - 2.0)
            .collect();
        let mut z = [0.5, 0.0];
        let (mut x, mut u) = (Vec::new(), Vec::new());
        for k in 0..self.rows {
            let push = levels[k / hold];
            x.push(z[0] + 0.01 * random.normal());
            u.push(push);
            let rate = |_: f64, z: &[f64; 2]| [z[1], (-4.0 * z[0] - 0.5 * z[1] + push) / self.mass];
            z = integrate(&rate, 0.0, self.step, z);
        }
        let time = grid(self.rows, self.step)
            .into_iter()
            .map(|t| self.from + t);
        [time.collect(), x, u]
    }
}

fn record(mass: f64, step: f64, rows: usize, from: f64, seed: u64) -> [Vec<f64>; 3] {
    Record {
        mass,
        step,
        rows,
        from,
        seed,
    }
    .columns()
}

/// A table of `columns`, with empty cells after the end of each.
fn table(header: &str, columns: &[&Vec<f64>]) -> String {
    let rows = columns.iter().map(|c| c.len()).max().unwrap_or(0);
    let mut text = format!("{header}\n");
    for k in 0..rows {
        let cell = |c: &&Vec<f64>| c.get(k).map_or(String::new(), f64::to_string);
        let cells: Vec<String> = columns.iter().map(cell).collect();
        text.push_str(&format!("{}\n", cells.join(",")));
    }
    text
}

fn csv([t, x, u]: &[Vec<f64>; 3]) -> String {
    table("t,x,u", &[t, x, u])
}

fn put(folder: &Path, files: &[(&str, String)]) {
    for (name, text) in files {
        fs::write(folder.join(name), text).unwrap();
    }
}

fn identify(files: &[(&str, String)], more: &[&str]) -> (Run, Value) {
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), files);
    let names: Vec<&str> = files.iter().map(|f| f.0).collect();
    let args = [&["identify", "-q", "--json"], &names[..], more].concat();
    let run = sidc_in(folder.path(), &args);
    let document = serde_json::from_str(&run.stdout).unwrap_or(Value::Null);
    (run, document)
}

/// Terms of the only equation with their coefficients.
fn terms(document: &Value) -> Vec<(String, f64)> {
    let terms = document["equations"][0]["terms"].as_array().unwrap();
    let pair = |t: &Value| {
        let name = t["term"].as_str().unwrap().to_owned();
        (name, t["coefficient"].as_f64().unwrap())
    };
    terms.iter().map(pair).collect()
}

fn close(document: &Value, wanted: &[(&str, f64)]) {
    let found = terms(document);
    let names: Vec<&str> = found.iter().map(|t| t.0.as_str()).collect();
    let known: Vec<&str> = wanted.iter().map(|t| t.0).collect();
    assert_eq!(names, known, "{found:?}");
    for ((name, value), (_, right)) in found.iter().zip(wanted) {
        assert!((value / right - 1.0).abs() < 0.02, "{name}: {value}");
    }
}

fn reason<'a>(document: &'a Value, code: &str) -> Option<&'a Value> {
    let reasons = document["equations"][0]["reasons"].as_array()?;
    reasons.iter().find(|r| r["code"] == code)
}

const PLANT: [(&str, f64); 3] = [("x", -4.0), ("dx", -0.5), ("u", 1.0)];

#[test]
fn runs_of_other_lengths_steps_and_starts_pool() {
    let (run, found) = identify(
        &[
            ("m.sid", MODEL.into()),
            ("a.csv", csv(&record(1.0, 0.02, 400, 0.0, 1))),
            ("b.csv", csv(&record(1.0, 0.05, 200, 5.0, 2))),
            ("c.csv", csv(&record(1.0, 0.03, 150, 2.0, 3))),
        ],
        &[],
    );
    assert_eq!(run.status, 0, "{}", run.stderr);
    close(&found, &PLANT);
}

/// From 3.2 s on, the sensor of one run reads something unrelated.
#[test]
fn a_bad_run_is_named_with_its_place_and_the_others_give_the_answer() {
    let [t, mut x, u] = record(1.0, 0.02, 400, 0.0, 7);
    let mut random = Random::new(9);
    for (t, x) in t.iter().zip(&mut x).filter(|(t, _)| **t > 3.2) {
        *x = 0.5 * (3.1 * t).sin().signum() + 0.01 * random.normal();
    }
    let (run, found) = identify(
        &[
            ("m.sid", MODEL.into()),
            ("a.csv", csv(&record(1.0, 0.02, 400, 0.0, 1))),
            ("bad.csv", csv(&[t, x, u])),
            ("c.csv", csv(&record(1.0, 0.03, 300, 2.0, 3))),
        ],
        &[],
    );
    assert_eq!(run.status, 3);
    close(&found, &PLANT);
    let text = reason(&found, "run-not-followed").unwrap()["text"].as_str();
    let text = text.unwrap();
    let time: f64 = text
        .split("bad.csv at ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next())
        .and_then(|t| t.parse().ok())
        .unwrap_or_else(|| panic!("{text}"));
    assert!((3.0..4.0).contains(&time), "{text}");
    assert_eq!(found["runs_left"], serde_json::json!(["bad.csv"]));
    assert!(text.contains("a.csv and c.csv"), "{text}");
}

#[test]
fn a_mass_that_differs_between_runs_is_found_and_declared() {
    let mut files = vec![
        ("m.sid", MODEL.to_string()),
        ("a.csv", csv(&record(1.0, 0.02, 400, 0.0, 1))),
        ("heavy.csv", csv(&record(1.25, 0.04, 300, 0.0, 4))),
    ];
    let (run, found) = identify(&files, &[]);
    assert_eq!(run.status, 3);
    let doubt = reason(&found, "runs-differ").unwrap();
    let line = doubt["remedy"]["change"]["model"][0].as_str().unwrap();
    assert_eq!(line, "coef(ddx, x), coef(ddx, dx), coef(ddx, u) : per run");

    files[0].1.push_str(line);
    let (run, found) = identify(&files, &[]);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    let terms = found["equations"][0]["terms"].as_array().unwrap();
    assert_eq!(terms.len(), 3);
    for (term, (name, right)) in terms.iter().zip(PLANT) {
        assert_eq!(term["term"], name);
        for (place, (run, mass)) in [("a.csv", 1.0), ("heavy.csv", 1.25)].iter().enumerate() {
            let own = &term["runs"][place];
            assert_eq!(own["run"], *run);
            let value = own["coefficient"].as_f64().unwrap();
            assert!(
                (value * mass / right - 1.0).abs() < 0.03,
                "{name} in {run}: {value}"
            );
        }
    }
}

/// Runs share all coefficients that are not declared per run.
#[test]
fn a_gain_alone_differs() {
    let heavy = record(1.0, 0.04, 300, 0.0, 4);
    // The actuator of one run pushes twice as hard as recorded.
    let [t, x, u] = heavy;
    let u = u.iter().map(|u| 0.5 * u).collect();
    let files = [
        (
            "m.sid",
            format!("{MODEL}constrain coef(ddx, u) : per run\n"),
        ),
        ("a.csv", csv(&record(1.0, 0.02, 400, 0.0, 1))),
        ("b.csv", csv(&[t, x, u])),
    ];
    let (run, found) = identify(&files, &[]);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    let terms = found["equations"][0]["terms"].as_array().unwrap();
    let runs: Vec<usize> = terms
        .iter()
        .map(|t| t["runs"].as_array().map_or(0, Vec::len))
        .collect();
    assert_eq!(runs, [0, 0, 2]);
    let gain = |k: usize| terms[2]["runs"][k]["coefficient"].as_f64().unwrap();
    assert!((gain(0) - 1.0).abs() < 0.02 && (gain(1) - 2.0).abs() < 0.04);
}

/// Every run is simulated with its own coefficients.
#[test]
fn simulations_take_the_coefficients_of_their_run() {
    let folder = tempfile::tempdir().unwrap();
    let model = format!("{MODEL}coef(ddx, x), coef(ddx, dx), coef(ddx, u) : per run\n");
    put(
        folder.path(),
        &[
            ("m.sid", model),
            ("a.csv", csv(&record(1.0, 0.02, 400, 0.0, 1))),
            ("heavy.csv", csv(&record(1.5, 0.04, 300, 0.0, 4))),
        ],
    );
    let run = |args: &[&str]| sidc_in(folder.path(), args);
    run(&[
        "identify",
        "-q",
        "m.sid",
        "a.csv",
        "heavy.csv",
        "-o",
        "r.json",
    ]);
    for file in ["a.csv", "heavy.csv"] {
        let run = run(&["simulate", "r.json", file, "--json", "-q"]);
        let document: Value = serde_json::from_str(&run.stdout).unwrap();
        let fit = document["runs"][0]["scores"][0]["fit_percent"].as_f64();
        assert!(fit.unwrap() > 90.0, "{file}: {fit:?}");
    }
    let code = run(&["export", "r.json", "--to", "c"]);
    assert!(
        code.stdout.contains("differs from run to run"),
        "{}",
        code.stdout
    );
    let regression = run(&["identify", "m.sid", "a.csv", "--method", "regression"]);
    assert_eq!(regression.status, 1);
    assert!(
        regression.stderr.contains("error[per-run]"),
        "{}",
        regression.stderr
    );
}

/// Two experiments side by side; the second is shorter and has its own times.
#[test]
fn experiments_side_by_side_are_runs() {
    let (a, b) = (
        record(1.0, 0.02, 400, 0.0, 1),
        record(1.0, 0.05, 200, 5.0, 2),
    );
    let columns = [&a[0], &a[2], &a[1], &b[0], &b[2], &b[1]];
    let side = table("tEst,uEst,yEst,tVal,uVal,yVal", &columns);
    let block =
        "data {\n  t = \"tEst\", \"tVal\"\n  x = \"yEst\", \"yVal\"\n  u = \"uEst\", \"uVal\"\n}\n";
    let (run, found) = identify(
        &[("m.sid", format!("{MODEL}{block}")), ("side.csv", side)],
        &[],
    );
    assert_eq!(run.status, 0, "{}", run.stderr);
    close(&found, &PLANT);
    let names = serde_json::json!(["side.csv (yEst)", "side.csv (yVal)"]);
    assert_eq!(found["settings"]["data"], names);

    // A missing column is reported with its place.
    let block = block.replace("yVal", "yval");
    let side = table("tEst,uEst,yEst,tVal,uVal,yVal", &columns);
    let (run, _) = identify(
        &[("m.sid", format!("{MODEL}{block}")), ("side.csv", side)],
        &[],
    );
    assert_eq!(run.status, 1);
    assert!(
        run.stderr.contains("did you mean \"yVal\"?"),
        "{}",
        run.stderr
    );
}

/// The same experiments stacked, with a column that identifies them.
#[test]
fn experiments_below_each_other_are_runs() {
    let mut text = String::from("id,t,x,u\n");
    let runs = [
        ("one", record(1.0, 0.02, 400, 0.0, 1)),
        ("two", record(1.0, 0.05, 200, 5.0, 2)),
    ];
    for (id, columns) in &runs {
        for row in csv(columns).lines().skip(1) {
            text.push_str(&format!("{id},{row}\n"));
        }
    }
    let model = format!("{MODEL}data {{ run = \"id\" }}\n");
    let (run, found) = identify(&[("m.sid", model), ("all.csv", text)], &[]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    close(&found, &PLANT);
}

/// `sign(dx)` has no derivative at its jump, so full steps of such a fit oscillate between two points.
#[test]
fn a_fit_with_a_jump_in_a_rate_is_not_lost() {
    let cart = |rows: usize, from: f64, seed: u64| {
        let mut random = Random::new(seed);
        let levels: Vec<f64> = (0..=rows / 12)
            .map(|_| 2.0 * random.uniform() - 1.0)
            .collect();
        let (mut z, mut x, mut u) = ([0.0, 0.0], Vec::new(), Vec::new());
        for k in 0..rows {
            let push = levels[k / 12];
            x.push(z[0] + 2e-4 * random.normal());
            u.push(push);
            // Short steps resolve the sticking.
            for _ in 0..40 {
                let force = -8.0 * z[1] + 8.0 * push - 0.3 * f64::signum(z[1]);
                z = [z[0] + z[1] * 0.025 / 40.0, z[1] + force * 0.025 / 40.0];
            }
        }
        let time: Vec<f64> = grid(rows, 0.025).into_iter().map(|t| from + t).collect();
        csv(&[time, x, u])
    };
    let model = "state x : order 2\ninput u : hold\nddx ~ <1, u, dx, sign dx>\n";
    let (_, found) = identify(
        &[
            ("m.sid", model.into()),
            ("a.csv", cart(500, 0.0, 1)),
            ("b.csv", cart(400, 3.0, 2)),
        ],
        &[],
    );
    assert!(found["failed"].as_array().is_none_or(Vec::is_empty));
    let found = terms(&found);
    let of = |name: &str| found.iter().find(|t| t.0 == name).map_or(0.0, |t| t.1);
    assert!((of("u") / 8.0 - 1.0).abs() < 0.02, "{found:?}");
    assert!((of("dx") / -8.0 - 1.0).abs() < 0.02, "{found:?}");
    assert!((of("sign(dx)") / -0.3 - 1.0).abs() < 0.1, "{found:?}");
}
