//! Prediction over a horizon: requests, answers, and exit statuses.

use std::path::Path;

use sidc::{Data, HoldOutRange, LawVerdict, Model, Options, RunStatus};
use sidc_testing::integrate::{grid, integrate};
use sidc_testing::program::{Run, sidc};
use sidc_testing::random::Random;
use sidc_testing::stochastic::path;
use sidc_testing::table::Table;

const PENDULUM: [&str; 2] = ["models/pendulum.sid", "models/data/pendulum.csv"];

fn identify(args: &[&str]) -> Run {
    sidc(&[&["identify", "-q"], args].concat())
}

/// The exit status and the document's verdict.
fn verdict(args: &[&str]) -> (i32, serde_json::Value) {
    let run = identify(&[args, &["--json"]].concat());
    let document: serde_json::Value =
        serde_json::from_str(&run.stdout).unwrap_or_else(|e| panic!("{e}: {}", run.stderr));
    (run.status, document["verdict"].clone())
}

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

/// A free pendulum with large swings and noisy positions: times and angles.
fn pendulum(rows: usize, noise: f64, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let time = grid(rows, 0.02);
    let law = |_: f64, x: &[f64; 2]| [x[1], -9.8 * x[0].sin() - 0.1 * x[1]];
    let (mut x, mut angles, mut random) = ([1.5, 0.0], Vec::new(), Random::new(seed));
    for (k, t) in time.iter().enumerate() {
        angles.push(x[0] + noise * random.normal());
        if let Some(next) = time.get(k + 1) {
            x = integrate(&law, *t, *next, x);
        }
    }
    (time, angles)
}

fn signal<'a>(verdict: &'a serde_json::Value, name: &str) -> &'a serde_json::Value {
    let signals = verdict["prediction"]["signals"].as_array().unwrap();
    signals.iter().find(|s| s["signal"] == name).unwrap()
}

fn figure(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap_or(f64::INFINITY)
}

#[test]
fn a_law_that_passes_is_good_or_not_by_what_is_asked() {
    let good = [&PENDULUM[..], &["--horizon", "0.5", "--good=10%"]].concat();
    let (status, told) = verdict(&good);
    assert_eq!((status, &told["law"]), (0, &"passes".into()));
    assert_eq!(told["prediction"]["good"], true);
    assert_eq!(told["prediction"]["on"], "held-out");
    assert_eq!(told["prediction"]["held_out"][0], "25%");
    let strict = ["--horizon", "0.5", "--good", "y=1e-30,theta=1"];
    let (status, told) = verdict(&[&PENDULUM[..], &strict].concat());
    assert_eq!((status, &told["law"]), (3, &"passes".into()));
    assert_eq!(told["prediction"]["good"], false);
    assert_eq!(signal(&told, "theta")["good"], true);
    assert_eq!(signal(&told, "y")["good"], false);
}

#[test]
fn a_law_that_is_doubted_is_good_or_not_by_what_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    let (time, angles) = pendulum(600, 0.01, 4);
    let mut table = Table::new(&["t", "th"]);
    time.iter()
        .zip(&angles)
        .for_each(|(t, a)| table.push(&[*t, *a]));
    let data = write(folder.path(), "p.csv", &table.csv());
    // The library lacks the sine, so the best equation is doubted.
    let model = "state th : order 2\nddth ~ <th, dth>\n";
    let model = write(folder.path(), "m.sid", model);
    let (status, told) = verdict(&[&model, &data, "--horizon", "0.1", "--good=20%"]);
    assert_eq!((status, &told["law"]), (0, &"doubted".into()), "{told}");
    let (status, told) = verdict(&[&model, &data, "--horizon", "0.1", "--good", "th=0.001"]);
    assert_eq!((status, &told["law"]), (3, &"doubted".into()));
    assert_eq!(told["prediction"]["good"], false);
    let shown = identify(&[&model, &data, "--horizon", "0.1", "--good=20%"]);
    assert_eq!(shown.status, 0);
    assert!(shown.stdout.contains("law: doubted (") && shown.stdout.contains("doubt["));
    assert!(shown.stdout.contains("good enough"), "{}", shown.stdout);
}

#[test]
fn noisy_positions_alone_are_predicted_from_fitted_states() {
    let model = Model::parse("state th : order 2\nddth ~ <sin(th), dth, th, th^3>\n").unwrap();
    let options = Options::default()
        .hold_out(HoldOutRange::Last(0.25))
        .horizon(1.0);
    let mut errors = Vec::new();
    for seed in 1..=8 {
        let (time, angles) = pendulum(800, 0.02, seed);
        let data = Data::new()
            .run([("t", &time[..]), ("th", &angles[..])])
            .unwrap();
        let found = model.identify(&data, &options).unwrap();
        let prediction = &found.verdict().unwrap().prediction;
        assert!(prediction.fitted_rows > 2, "{prediction:?}");
        let [th] = prediction.signals.as_slice() else {
            panic!("{prediction:?}")
        };
        let (error, kept) = (th.error.rms.unwrap(), th.no_change.rms.unwrap());
        assert!(kept > 0.5 && error < 0.1 * kept, "{error} {kept}");
        assert!(error < 0.5 * th.linear.unwrap().rms.unwrap());
        assert!(th.curve.windows(2).all(|w| w[0].ahead < w[1].ahead));
        errors.push(error);
    }
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    // The readings used for comparison have noise of 0.02 themselves.
    assert!(mean < 0.026 && mean > 0.015, "{errors:?}");
}

#[test]
fn chaos_is_followed_until_its_start_is_forgotten() {
    let folder = tempfile::tempdir().unwrap();
    let law = |_: f64, x: &[f64; 3]| {
        [
            10.0 * (x[1] - x[0]),
            x[0] * (28.0 - x[2]) - x[1],
            x[0] * x[1] - 8.0 / 3.0 * x[2],
        ]
    };
    let (time, mut random) = (grid(3_000, 0.01), Random::new(2));
    let (mut x, mut table) = ([1.0, 3.0, 20.0], Table::new(&["t", "x", "y", "z"]));
    for t in time {
        let read = x.map(|v| v + 0.02 * random.normal());
        table.push(&[t, read[0], read[1], read[2]]);
        x = integrate(&law, t, t + 0.01, x);
    }
    let data = write(folder.path(), "lorenz.csv", &table.csv());
    let model = "state x, y, z\ndx, dy, dz ~ poly(x, y, z; 2)\n";
    let model = write(folder.path(), "lorenz.sid", model);
    let (_, told) = verdict(&[&model, &data, "--holdout=40%"]);
    let x = signal(&told, "x");
    // Errors of 0.3 % of the spread grow by a factor of e in 1.1 s, and half the spread is a factor of e^5 away.
    let follows = figure(&x["follows"]);
    let curve = x["curve"].as_array().unwrap();
    let longest = figure(&curve.last().unwrap()["ahead"]);
    assert!(figure(&x["error"]["rms"]) < 0.1, "{x}");
    assert!(
        (1.0..longest.max(1.5)).contains(&follows) || longest < 2.0,
        "{follows} of {longest}"
    );
    assert_eq!(told["run"]["status"], "sensitive");
    assert_eq!(told["law"], "passes", "{told}");
}

/// θ̈ = 20 sin θ + u, stabilised by u from noisy readings and pushed from time to time: time, angle, input.
fn balanced(rows: usize) -> [Vec<f64>; 3] {
    let (time, mut random) = (grid(rows, 0.02), Random::new(7));
    let push = random.square(rows, (10, 30), 4.0);
    let (mut x, mut last, mut out) = ([0.1, 0.0], 0.1, [time.clone(), Vec::new(), Vec::new()]);
    for (t, push) in time.iter().zip(push) {
        let read = x[0] + 0.003 * random.normal();
        let u = -45.0 * read - 6.0 * (read - last) / 0.02 + push;
        last = read;
        out[1].push(read);
        out[2].push(u);
        x = integrate(
            &|_, x: &[f64; 2]| [x[1], 20.0 * x[0].sin() + u],
            *t,
            t + 0.02,
            x,
        );
    }
    out
}

#[test]
fn an_unstable_plant_is_judged_by_prediction_and_not_by_its_free_run() {
    let [time, angle, input] = balanced(1_200);
    let columns = [("t", &time[..]), ("th", &angle[..]), ("u", &input[..])];
    let data = Data::new().run(columns).unwrap();
    let model = "state th : order 2\ninput u : hold\nddth ~ <sin(th), dth, u, 1>\n";
    let model = Model::parse(model).unwrap();
    let options = Options::default().horizon(0.26).good(0.5);
    let found = model.identify(&data, &options).unwrap();
    let verdict = found.verdict().unwrap();
    assert_eq!(
        verdict.run.status,
        RunStatus::Sensitive,
        "{:?}",
        verdict.run
    );
    let th = &verdict.prediction.signals[0];
    let (error, kept) = (th.error.rms.unwrap(), th.no_change.rms.unwrap());
    assert!(error < 0.35 * kept, "{error} {kept}");
    assert_eq!(found.is_good(), Some(true));
    let free = ["not-carried-over", "run-leaves-data"];
    assert!(
        found
            .doubts()
            .all(|(_, r)| !free.contains(&r.code.as_str()))
    );
}

#[test]
fn what_holds_for_the_data_used_alone_is_doubted_though_the_plant_is_unstable() {
    let [time, angle, mut input] = balanced(1_200);
    // In the held-out part, the recorded input belongs to another actuator.
    for (k, u) in input.iter_mut().enumerate().skip(840) {
        *u = 6.0 * (0.05 * k as f64).sin();
    }
    let columns = [("t", &time[..]), ("th", &angle[..]), ("u", &input[..])];
    let data = Data::new().run(columns).unwrap();
    let model = "state th : order 2\ninput u : hold\nddth ~ <sin(th), dth, u, 1>\n";
    let model = Model::parse(model).unwrap();
    let options = Options::default()
        .hold_out(HoldOutRange::Last(0.3))
        .horizon(0.26);
    let found = model.identify(&data, &options).unwrap();
    let codes: Vec<&str> = found.doubts().map(|(_, r)| r.code.as_str()).collect();
    assert!(codes.contains(&"not-carried-over"), "{codes:?}");
    assert_eq!(found.verdict().unwrap().law, LawVerdict::Doubted);
}

#[test]
fn what_cannot_be_asked_says_so() {
    let run = identify(&[PENDULUM[0], PENDULUM[1], "--good", "thta=0.1"]);
    assert_eq!(run.status, 1, "{}", run.stderr);
    assert!(run.stderr.contains("error[unknown-good]") && run.stderr.contains("theta"));
    let (status, told) = verdict(&[PENDULUM[0], PENDULUM[1], "--horizon", "100", "--good=10%"]);
    assert_eq!((status, &told["prediction"]["good"]), (3, &false.into()));
    assert_eq!(told["prediction"]["unavailable"]["code"], "no-horizon");
    let text = identify(&[PENDULUM[0], PENDULUM[1], "--horizon", "100"]);
    assert_eq!(text.status, 0);
    assert!(
        text.stdout.contains("prediction: none: "),
        "{}",
        text.stdout
    );
}

#[test]
fn without_data_held_out_predictions_are_labelled() {
    let (_, told) = verdict(&PENDULUM);
    assert_eq!(told["prediction"]["on"], "used");
    assert_eq!(told["prediction"]["good"], serde_json::Value::Null);
    assert_eq!(told["run"]["status"], "follows");
    let text = identify(&PENDULUM);
    assert!(text.stdout.contains("starts on the data used"));
    let widest = text
        .stdout
        .lines()
        .filter(|l| l.starts_with("prediction"))
        .map(|l| l.chars().count());
    assert!(widest.max() <= Some(120));
}

#[test]
fn discrete_systems_are_predicted_in_samples() {
    let (_, told) = verdict(&[
        "models/logistic_map.sid",
        "models/data/logistic_map.csv",
        "--holdout=25%",
    ]);
    assert_eq!(told["prediction"]["unit"], "samples");
    let signals = told["prediction"]["signals"].as_array().unwrap();
    let exact = |s: &serde_json::Value| figure(&s["error"]["rms"]) < 1e-6 * figure(&s["spread"]);
    assert!(!signals.is_empty() && signals.iter().all(exact), "{told}");
}

#[test]
fn bands_hold_what_they_promise_on_data_held_out() {
    let law = |x: &[f64; 1]| [x[0] - x[0].powi(3)];
    let mut random = Random::new(12);
    let path = path(&law, [0.5], [0.2], (4001, 0.05), &mut random);
    let x: Vec<f64> = path.iter().map(|x| x[0]).collect();
    let data = Data::new()
        .run([("t", &grid(4001, 0.05)[..]), ("x", &x[..])])
        .unwrap();
    let model = Model::parse("state x : order 1\ndx ~ poly(x; 3)\n").unwrap();
    let options = Options::default().hold_out(HoldOutRange::Last(0.3));
    let found = model.identify(&data, &options.horizon(1.0)).unwrap();
    let prediction = &found.verdict().unwrap().prediction;
    let band = prediction.signals[0].band.as_ref().unwrap();
    let held = band.held_out.as_ref().unwrap();
    assert_eq!((band.predictions, held.course.len()), (400, 400));
    // Predictions within a second share their errors: about 60 of the 400 are independent, so 90 % has a standard error of 4 %.
    assert!((held.fixed - 0.9).abs() < 0.12, "{}", held.fixed);
    assert!((held.following - 0.9).abs() < 0.04, "{}", held.following);
}

#[test]
fn errors_beyond_those_of_the_data_used_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let law =
        |t: f64, x: &[f64; 1]| [(if t < 30.0 { -1.0 } else { -3.0 }) * x[0] + (0.7 * t).sin()];
    let (mut x, mut random) = ([1.0], Random::new(3));
    let mut table = Table::new(&["t", "x", "u"]);
    for t in grid(800, 0.05) {
        table.push(&[t, x[0] + 0.005 * random.normal(), (0.7 * t).sin()]);
        x = integrate(&law, t, t + 0.05, x);
    }
    let data = write(folder.path(), "d.csv", &table.csv());
    let model = "state x : order 1\ninput u : linear\ndx ~ <x, u>\n";
    let model = write(folder.path(), "m.sid", model);
    let told = identify(&[&model, &data, "--horizon", "1", "--holdout", "25%"]).stdout;
    assert!(told.contains("x there beyond the 0.0"), "{told}");
    assert!(told.contains(" instead of 10"), "{told}");
}
