//! Delays declared in a model: of inputs, which act later than recorded, and of sensors, which read late. The systems are integrated here by small fixed
//! steps from knot to knot, so that the coefficients are known.

use std::fs;
use std::path::Path;

use serde_json::Value;
use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, sidc_in};

const STEP: f64 = 0.05;
const ROWS: usize = 300;
/// A delay of 2.37 samples.
const DELAY: f64 = 2.37 * STEP;
/// The law ddx = -4 x - 0.4 dx + u.
const LAW: [(&str, f64); 3] = [("x", -4.0), ("dx", -0.4), ("u", 1.0)];

/// How an input moves between its samples.
#[derive(Clone, Copy, PartialEq)]
enum Moves {
    Held,
    Straight,
}

impl Moves {
    fn word(self) -> &'static str {
        match self {
            Moves::Held => "hold",
            Moves::Straight => "linear",
        }
    }

    fn at(self, u: &[f64], t: f64) -> f64 {
        let place = (t / STEP).clamp(0.0, (u.len() - 1) as f64);
        let k = (place + 1e-9).floor() as usize;
        match (self, u.get(k + 1)) {
            (Moves::Straight, Some(next)) => u[k] + (place - k as f64) * (next - u[k]),
            _ => u[k],
        }
    }
}

/// A level that changes every six samples, smoothed to ramps for inputs that are linear between samples.
fn input(moves: Moves, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    let mut level = 0.0;
    let mut levels = Vec::new();
    for k in 0..ROWS {
        if k % 6 == 0 {
            level = random.normal();
        }
        levels.push(level);
    }
    if moves == Moves::Held {
        return levels;
    }
    let mean = |k: usize| levels[k.saturating_sub(4)..=k].iter().sum::<f64>() / 5.0;
    (0..ROWS).map(mean).collect()
}

/// Position and velocity at these times, from x = 1 at rest at t = 0, with the input delayed by `late` seconds. Fourth-order Runge–Kutta with eight steps
/// between consecutive times or knots of the input.
fn states(u: &[f64], moves: Moves, late: f64, instants: &[f64]) -> Vec<[f64; 2]> {
    let mut knots: Vec<f64> = (0..ROWS).map(|k| k as f64 * STEP + late).collect();
    knots.extend(instants);
    knots.push(0.0);
    knots.sort_by(f64::total_cmp);
    knots.dedup_by(|b, a| *b - *a < 1e-12);
    let last = instants.last().copied().unwrap();
    let mut z = [1.0, 0.0];
    let mut found = vec![[1.0, 0.0]; instants.len()];
    let ahead = |z: [f64; 2], k: [f64; 2], h: f64| [z[0] + h * k[0], z[1] + h * k[1]];
    for pair in knots
        .windows(2)
        .filter(|p| p[1] > 0.0 && p[1] <= last + 1e-12)
    {
        let h = (pair[1] - pair[0]) / 8.0;
        for part in 0..8 {
            let at = pair[0] + f64::from(part) * h;
            // Just inside the step, where a held input has a unique value.
            let inside = [at + 1e-7 * h, at + 0.5 * h, at + (1.0 - 1e-7) * h];
            let [a, b, c] = inside.map(|t| moves.at(u, t - late));
            let rate = |z: [f64; 2], u: f64| [z[1], -4.0 * z[0] - 0.4 * z[1] + u];
            let k1 = rate(z, a);
            let k2 = rate(ahead(z, k1, 0.5 * h), b);
            let k3 = rate(ahead(z, k2, 0.5 * h), b);
            let k4 = rate(ahead(z, k3, h), c);
            let sum = |i: usize| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0;
            z = ahead(z, [sum(0), sum(1)], h);
        }
        if let Some(place) = instants.iter().position(|t| (t - pair[1]).abs() < 1e-12) {
            found[place] = z;
        }
    }
    found
}

fn times() -> Vec<f64> {
    (0..ROWS).map(|k| k as f64 * STEP).collect()
}

fn table(columns: &[(&str, Vec<f64>)]) -> String {
    let names: Vec<&str> = columns.iter().map(|(n, _)| *n).collect();
    let mut text = format!("t,{}\n", names.join(","));
    for (k, t) in times().iter().enumerate() {
        let cells: Vec<String> = columns.iter().map(|(_, c)| c[k].to_string()).collect();
        text.push_str(&format!("{t},{}\n", cells.join(",")));
    }
    text
}

fn noisy(x: impl Iterator<Item = f64>, sigma: f64, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    x.map(|x| x + sigma * random.normal()).collect()
}

/// The record of a position under an input that acts [`DELAY`] late.
fn late_input(moves: Moves, sigma: f64) -> String {
    let u = input(moves, 9);
    let z = states(&u, moves, DELAY, &times());
    let x = noisy(z.iter().map(|z| z[0]), sigma, 4);
    table(&[("x", x), ("u", u)])
}

fn identify(folder: &Path, model: &str, record: &str, options: &[&str]) -> (Run, Value) {
    fs::write(folder.join("m.sid"), model).unwrap();
    fs::write(folder.join("a.csv"), record).unwrap();
    let fixed = ["identify", "m.sid", "a.csv", "-q", "--json", "-o", "r.json"];
    let run = sidc_in(folder, &[&fixed[..], options].concat());
    let document = serde_json::from_str(&run.stdout);
    let document = document.unwrap_or_else(|_| panic!("{}{}", run.stdout, run.stderr));
    (run, document)
}

/// The largest error of a coefficient of ddx, over all terms.
fn off(document: &Value) -> f64 {
    let terms = document["equations"][0]["terms"].as_array().unwrap();
    let found = |name: &str| {
        let term = terms.iter().find(|t| t["term"] == name);
        term.map_or(0.0, |t| t["coefficient"].as_f64().unwrap())
    };
    let own = LAW
        .iter()
        .map(|(name, wanted)| (found(name) - wanted).abs());
    let others = terms
        .iter()
        .filter(|t| LAW.iter().all(|(name, _)| t["term"] != *name));
    let others = others.map(|t| t["coefficient"].as_f64().unwrap().abs());
    own.chain(others).fold(0.0, f64::max)
}

fn model(moves: Moves, delay: &str) -> String {
    let word = moves.word();
    format!("state x : order 2\ninput u : {word}{delay}\nddx ~ poly(x, dx; 2) + u\n")
}

const KNOWN: &str = ", delay 0.1185";
const SOUGHT: &str = ", delay in 0..0.3";

#[test]
fn a_known_delay_gives_the_coefficients_that_are_wrong_without_it() {
    let folder = tempfile::tempdir().unwrap();
    for moves in [Moves::Held, Moves::Straight] {
        let record = late_input(moves, 1e-4);
        let with = identify(folder.path(), &model(moves, KNOWN), &record, &[]);
        assert_eq!(with.0.status, 0, "{}", with.0.stdout);
        assert!(off(&with.1) < 1e-3, "{}", with.0.stdout);
        assert_eq!(with.1["delays"][0]["seconds"], 0.1185);
        let whole = identify(folder.path(), &model(moves, ", delay 0.1"), &record, &[]);
        assert!(off(&whole.1) > 1e-2, "{}", whole.0.stdout);
        assert_eq!(whole.0.status, 3, "{}", whole.0.stdout);
    }
}

#[test]
fn regression_knows_a_delay_too() {
    let folder = tempfile::tempdir().unwrap();
    for moves in [Moves::Held, Moves::Straight] {
        let u = input(moves, 9);
        let z = states(&u, moves, DELAY, &times());
        let rate = |(t, z): (&f64, &[f64; 2])| -4.0 * z[0] - 0.4 * z[1] + moves.at(&u, t - DELAY);
        let record = table(&[
            ("x", z.iter().map(|z| z[0]).collect()),
            ("dx", z.iter().map(|z| z[1]).collect()),
            ("ddx", times().iter().zip(&z).map(rate).collect()),
            ("u", u.clone()),
        ]);
        let options = ["--method", "regression"];
        let with = identify(folder.path(), &model(moves, KNOWN), &record, &options);
        // Rates from samples without noise are accurate up to the error of the local polynomial.
        assert!(off(&with.1) < 5e-3, "{}", with.0.stdout);
        assert_eq!(with.0.status, 0, "{}", with.0.stdout);
        let without = identify(folder.path(), &model(moves, ""), &record, &options);
        assert!(off(&without.1) > 1e-2, "{}", without.0.stdout);
    }
}

#[test]
fn a_delay_that_is_sought_is_in_its_interval() {
    let folder = tempfile::tempdir().unwrap();
    for (moves, sigma) in [
        (Moves::Held, 0.001),
        (Moves::Held, 0.01),
        (Moves::Straight, 0.001),
        (Moves::Held, 0.05),
    ] {
        let record = late_input(moves, sigma);
        let (run, document) = identify(folder.path(), &model(moves, SOUGHT), &record, &[]);
        let delay = &document["delays"][0];
        let [low, high] = [0, 1].map(|i| delay["interval"][i].as_f64().unwrap());
        assert!(low < DELAY && DELAY < high, "{delay}");
        // About the precision that a change of level between two readings allows.
        assert!(high - low < 6.0 * sigma, "{delay}");
        assert!(off(&document) < 6.0 * sigma, "{}", run.stdout);
        assert_eq!(run.status, 0, "{}", run.stdout);
    }
}

/// The readings of x are delayed by [`DELAY`], those of v are not.
fn late_sensor(sigma: f64) -> String {
    let u = input(Moves::Held, 9);
    let early: Vec<f64> = times().iter().map(|t| (t - DELAY).max(0.0)).collect();
    let x = states(&u, Moves::Held, 0.0, &early);
    let v = states(&u, Moves::Held, 0.0, &times());
    table(&[
        ("x", noisy(x.iter().map(|z| z[0]), sigma, 4)),
        ("v", noisy(v.iter().map(|z| z[1]), sigma, 5)),
        ("u", u),
    ])
}

#[test]
fn the_sensor_of_one_of_two_states_reads_late() {
    let folder = tempfile::tempdir().unwrap();
    let record = late_sensor(0.002);
    let model = |delay: &str| {
        format!("state x{delay}\nstate v\ninput u : hold\ndx ~ <v, u>\ndv ~ poly(x, v; 2) + u\n")
    };
    for delay in [" : delay 0.1185", " : delay in 0..0.3"] {
        let (run, document) = identify(folder.path(), &model(delay), &record, &["--verify"]);
        assert_eq!(run.status, 0, "{}", run.stdout);
        let found = document["delays"][0]["seconds"].as_f64().unwrap();
        assert!((found - DELAY).abs() < 2e-3, "{}", document["delays"]);
        let coefficient = document["equations"][0]["terms"][0]["coefficient"].as_f64();
        assert!((coefficient.unwrap() - 1.0).abs() < 5e-3, "{}", run.stdout);
    }
    let (run, _) = identify(folder.path(), &model(""), &record, &[]);
    assert_eq!(run.status, 3, "{}", run.stdout);
}

#[test]
fn a_simulation_of_the_result_is_the_motion() {
    let folder = tempfile::tempdir().unwrap();
    let record = late_input(Moves::Held, 1e-4);
    let (_, document) = identify(folder.path(), &model(Moves::Held, SOUGHT), &record, &[]);
    let args = [
        "simulate", "r.json", "a.csv", "-o", "run.csv", "--start", "x=1,dx=0",
    ];
    let run = sidc_in(folder.path(), &args);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    let text = fs::read_to_string(folder.path().join("run.csv")).unwrap();
    let place = text
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|c| c == "x")
        .unwrap();
    let simulated = text
        .lines()
        .skip(1)
        .map(|l| l.split(',').nth(place).unwrap().parse::<f64>().unwrap());
    let seconds = document["delays"][0]["seconds"].as_f64().unwrap();
    let u = input(Moves::Held, 9);
    let truth = states(&u, Moves::Held, seconds, &times());
    for (k, (x, z)) in simulated.zip(&truth).enumerate() {
        assert!((x - z[0]).abs() < 2e-3, "row {k}: {x}, {}", z[0]);
    }
    let export = sidc_in(folder.path(), &["export", "r.json", "--to", "c"]);
    let wanted = format!("#define SIDC_INPUT_DELAYS {{{seconds:?}}}");
    assert!(export.stdout.contains(&wanted), "{}", export.stdout);
}

#[test]
fn what_the_answer_says_of_delays() {
    let folder = tempfile::tempdir().unwrap();
    let record = late_input(Moves::Held, 0.01);
    let mut said = String::new();
    for delay in [KNOWN, SOUGHT, ", delay in 0..0.08", ""] {
        fs::write(folder.path().join("m.sid"), model(Moves::Held, delay)).unwrap();
        fs::write(folder.path().join("a.csv"), &record).unwrap();
        let run = sidc_in(folder.path(), &["identify", "m.sid", "a.csv", "-q"]);
        said.push_str(&format!("== input u : hold{delay}\n{}\n", run.stdout));
    }
    insta::assert_snapshot!(said);
}

#[test]
fn delays_that_no_data_can_tell_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let record = late_input(Moves::Held, 0.01);
    let mut said = String::new();
    for (delay, options) in [
        (", delay in 0..9", &[][..]),
        (", delay 20", &[]),
        (SOUGHT, &["--method", "regression"]),
        (SOUGHT, &["--samples", "100"]),
    ] {
        fs::write(folder.path().join("m.sid"), model(Moves::Held, delay)).unwrap();
        fs::write(folder.path().join("a.csv"), &record).unwrap();
        let run = sidc_in(
            folder.path(),
            &[&["identify", "m.sid", "a.csv", "-q"], options].concat(),
        );
        assert_eq!(run.status, 1, "{}", run.stdout);
        said.push_str(&format!("{}\n", run.stderr));
    }
    insta::assert_snapshot!(said);
}
