//! Unmeasured states: found with the laws, given in one scale, and started from the readings in every run.

use std::fs;
use std::path::Path;

use serde_json::Value;
use sidc::Unwatched;
use sidc::pipeline::Program;
use sidc_data as data;
use sidc_data::Limits;
use sidc_discover::{Options, SearchScope, describe_jointly, joint};
use sidc_lang::source::Sources;
use sidc_testing::integrate::{grid, integrate};
use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, sidc_in};

const STEP: f64 = 2.0;
const ROWS: usize = 500;
/// The law dT = 0.207 - 0.009 T + 0.006 H, dH = (Q - H)/27.
const BLOCK: [f64; 3] = [0.207, -0.009, 0.006];
const LAG: f64 = 27.0;

/// A heated block with an unmeasured heater; `noise` is that of the readings.
fn heater(seed: u64, noise: f64) -> String {
    let mut random = Random::new(seed);
    let times = grid(ROWS, STEP);
    let (mut state, mut level) = ([23.0, 0.0], 0.0);
    let mut text = String::from("t,T,Q\n");
    for (k, t) in times.iter().enumerate() {
        if k % 40 == 0 {
            level = (50.0 + 30.0 * random.normal()).clamp(0.0, 100.0);
        }
        let read = state[0] + noise * random.normal();
        text += &format!("{t},{read:.6},{level}\n");
        let f = |_: f64, &[block, heater]: &[f64; 2]| {
            [
                BLOCK[0] + BLOCK[1] * block + BLOCK[2] * heater,
                (level - heater) / LAG,
            ]
        };
        state = integrate(&f, *t, t + STEP, state);
    }
    text
}

fn identify(folder: &Path, model: &str, data: &str, more: &[&str]) -> (Run, Value) {
    fs::write(folder.join("m.sid"), model).unwrap();
    fs::write(folder.join("run.csv"), data).unwrap();
    let mut arguments = vec!["identify", "m.sid", "run.csv", "-o", "r.json"];
    arguments.extend(more);
    let run = sidc_in(folder, &arguments);
    let text = fs::read_to_string(folder.join("r.json")).unwrap_or_default();
    (run, serde_json::from_str(&text).unwrap_or_default())
}

fn coefficient(document: &Value, target: &str, term: &str) -> f64 {
    let equations = document["equations"].as_array().unwrap();
    let equation = equations.iter().find(|e| e["target"] == target).unwrap();
    let terms = equation["terms"].as_array().unwrap();
    let found = terms.iter().find(|t| t["term"] == term);
    found.map_or(0.0, |t| t["coefficient"].as_f64().unwrap())
}

fn near(found: f64, truth: f64, part: f64) {
    assert!(
        (found - truth).abs() <= part * truth.abs(),
        "{found} is not {truth}"
    );
}

const GIVEN: &str = "state T\nstate H : hidden\ninput Q : hold\nunknown tau in 1..1000\ndH = (Q - H)/tau\ndT ~ <1, T, T^2, H, Q>\n";
const SOUGHT: &str =
    "state T\nstate H : hidden\ninput Q : hold\ndH ~ <H, Q, Q^2>\ndT ~ <1, T, H, T^2>\n";

#[test]
fn a_given_law_is_followed_and_its_constant_found() {
    let folder = tempfile::tempdir().unwrap();
    let (run, document) = identify(folder.path(), GIVEN, &heater(1, 0.1), &[]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    near(coefficient(&document, "dT", "1"), BLOCK[0], 0.02);
    near(coefficient(&document, "dT", "T"), BLOCK[1], 0.02);
    near(coefficient(&document, "dT", "H"), BLOCK[2], 0.02);
    assert_eq!(coefficient(&document, "dT", "T^2"), 0.0);
    let tau = &document["unknowns"][0];
    let ends = [&tau["interval"][0], &tau["interval"][1]].map(|e| e.as_f64().unwrap());
    assert!(ends[0] < LAG && LAG < ends[1], "{tau}");
    let hidden = &document["hidden"][0];
    assert_eq!(hidden["name"], "H");
    assert!(hidden["scale"].is_null());
    assert!(hidden["starts"][0]["value"].as_f64().unwrap().abs() < 5.0);
}

#[test]
fn a_sought_law_is_found_in_the_scale_that_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let (run, document) = identify(folder.path(), SOUGHT, &heater(2, 0.1), &[]);
    assert_eq!(coefficient(&document, "dT", "H"), 1.0, "{}", run.stdout);
    assert_eq!(document["hidden"][0]["scale"]["term"], "H");
    // The order of the two lags is open, but their sum and product are those of the block.
    let (a, b) = (
        coefficient(&document, "dT", "T"),
        coefficient(&document, "dH", "H"),
    );
    near(a + b, BLOCK[1] - 1.0 / LAG, 0.03);
    near(a * b, -BLOCK[1] / LAG, 0.03);
    near(coefficient(&document, "dH", "Q"), BLOCK[2] / LAG, 0.03);
    // No reading shows the order, and the answer must say so.
    assert_eq!(run.status, 3);
    assert!(
        run.words().contains("in which order lags follow"),
        "{}",
        run.stdout
    );
}

/// Readings of x and y of Lorenz' system from a start, with noise of a part of their spread.
fn convection(start: [f64; 3], noise: f64) -> String {
    let mut random = Random::new(1);
    let rates =
        |_: f64, [x, y, z]: &[f64; 3]| [10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z];
    let (step, mut state) = (0.01, start);
    let mut text = String::from("t,x,y\n");
    for k in 0..1500 {
        let t = step * f64::from(k);
        let (x, y) = (
            state[0] + 8.0 * noise * random.normal(),
            state[1] + 9.0 * noise * random.normal(),
        );
        text += &format!("{t},{x:.6},{y:.6}\n");
        state = integrate(&rates, t, t + step, state);
    }
    text
}

/// A guessed time constant that is not quite right lets other terms in; with little noise the guess also has a multiple of a measured state.
#[test]
fn a_sought_law_is_found_from_any_start() {
    let model = "system m\nstate x, y\nstate z : hidden\ndx, dy, dz ~ poly(x, y, z; 2)\n";
    for (start, noise) in [([3.0, -5.0, 20.0], 0.01), ([1.0, 1.0, 25.0], 0.001)] {
        let folder = tempfile::tempdir().unwrap();
        let (run, found) = identify(folder.path(), model, &convection(start, noise), &[]);
        assert_eq!(run.status, 0, "{start:?}: {}{}", run.stdout, run.stderr);
        let number = |target: &str, term: &str| coefficient(&found, target, term);
        near(number("dx", "x"), -10.0, 0.01);
        near(number("dx", "y"), 10.0, 0.01);
        near(number("dy", "y"), -1.0, 0.02);
        near(number("dz", "z"), -8.0 / 3.0, 0.01);
        // The scale is set by one of these two; their product has none.
        near(number("dy", "x*z") * number("dz", "x*y"), -1.0, 0.01);
        let terms = |e: &Value| e["terms"].as_array().unwrap().len();
        let equations = found["equations"].as_array().unwrap();
        assert_eq!(
            equations.iter().map(terms).sum::<usize>(),
            7,
            "{}",
            run.stdout
        );
    }
}

/// Prey alone is read. The predators b also obey laws of five terms as b + c a + d, and a search that drops one term at a time stays there.
#[test]
fn a_hidden_state_is_shifted_to_where_its_laws_have_the_fewest_terms() {
    let mut random = Random::new(2);
    let rates = |_: f64, [a, b]: &[f64; 2]| [0.9 * a - 0.5 * a * b, -0.7 * b + 0.3 * a * b];
    let (step, mut state) = (0.05, [2.5, 1.5]);
    let mut text = String::from("t,a\n");
    for k in 0..1500 {
        let t = step * f64::from(k);
        text += &format!("{t},{:.6}\n", state[0] + 0.005 * random.normal());
        state = integrate(&rates, t, t + step, state);
    }
    let model = "system m\nstate a\nstate b : hidden\nda, db ~ poly(a, b; 2)\n";
    let folder = tempfile::tempdir().unwrap();
    let (run, found) = identify(folder.path(), model, &text, &[]);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    near(coefficient(&found, "da", "a"), 0.9, 0.01);
    near(coefficient(&found, "db", "b"), -0.7, 0.01);
    near(coefficient(&found, "db", "a*b"), 0.3, 0.01);
    let equations = found["equations"].as_array().unwrap();
    let terms = |e: &Value| e["terms"].as_array().unwrap().len();
    assert_eq!(
        equations.iter().map(terms).sum::<usize>(),
        4,
        "{}",
        run.stdout
    );
}

#[test]
fn parameters_that_no_reading_tells_apart_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let model = GIVEN
        .replace("unknown tau", "unknown k in 0.01..100\nunknown tau")
        .replace("(Q - H)", "(k*Q - H)")
        .replace("T^2, H, Q", "H");
    fs::write(folder.path().join("m.sid"), &model).unwrap();
    fs::write(folder.path().join("d.csv"), heater(3, 0.1)).unwrap();
    let run = sidc_in(folder.path(), &["identify", "m.sid", "d.csv"]);
    let refused = "error[unidentifiable-constant]: no readings can tell k: only its product with coef(dT, H) acts on what is read";
    assert!(
        run.status == 1 && run.stderr.contains(refused),
        "{}",
        run.stderr
    );
    // Of laws that may switch it is told after the search.
    let model = model.replace("H>", "H, abs(Q - 50)>");
    let (run, document) = identify(folder.path(), &model, &heater(3, 0.1), &[]);
    assert_eq!(run.status, 3, "{}", run.stdout);
    let reasons = document["equations"][1]["reasons"].as_array().unwrap();
    let found = reasons.iter().find(|r| r["code"] == "unidentifiable");
    let text = found.unwrap()["text"].as_str().unwrap();
    assert!(
        text.contains("k ") && text.contains("coef(dT, H)"),
        "{text}"
    );
    // Their product is that of the block.
    let k = document["unknowns"].as_array().unwrap();
    let k = k.iter().find(|u| u["name"] == "k").unwrap()["value"].as_f64();
    near(
        k.unwrap() * coefficient(&document, "dT", "H"),
        BLOCK[2],
        0.03,
    );
}

#[test]
fn runs_start_hidden_states_from_the_readings() {
    let folder = tempfile::tempdir().unwrap();
    let data = heater(4, 0.02);
    let (run, document) = identify(folder.path(), GIVEN, &data, &["--holdout=30%"]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    let held = &document["validation"]["runs"][1];
    assert_eq!(held["held_out"], true);
    let fit = held["scores"][0]["fit_percent"].as_f64().unwrap();
    assert!(fit > 99.0, "{held}");
    let again = sidc_in(folder.path(), &["simulate", "r.json", "run.csv"]);
    assert_eq!(again.status, 0, "{}{}", again.stdout, again.stderr);
    assert!(again.words().contains("fitted"), "{}", again.stdout);
}

#[test]
fn exported_code_has_hidden_states_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let (_, _) = identify(folder.path(), GIVEN, &heater(5, 0.1), &[]);
    let code = sidc_in(folder.path(), &["export", "--to", "python", "r.json"]);
    assert!(
        code.words().contains("H is hidden"),
        "{}{}",
        code.stdout,
        code.stderr
    );
}

#[test]
fn what_cannot_be_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let data = heater(6, 0.1);
    let without = "state T\nstate H : hidden\ninput Q : hold\ndT ~ <1, T, H>\n";
    let (run, _) = identify(folder.path(), without, &data, &[]);
    assert_eq!(run.status, 1);
    assert!(run.stderr.contains("error[hidden-state]"), "{}", run.stderr);
    assert!(run.stderr.contains("dH ~ <u, H>"), "{}", run.stderr);
    let (run, _) = identify(folder.path(), GIVEN, &data, &["--method=regression"]);
    assert_eq!(run.status, 1);
    assert!(
        run.stderr.contains("error[hidden-not-estimated]"),
        "{}",
        run.stderr
    );
    let named = data.replace("t,T,Q", "t,H,Q");
    let model = GIVEN.replace("state T", "state T\ndata { T = \"H\" }");
    let (run, _) = identify(folder.path(), &model, &named, &[]);
    assert!(
        run.stderr.contains("note[hidden-in-data]"),
        "{}",
        run.stderr
    );
}

const FINE: f64 = 0.01;
/// Time constant in seconds of the lag before or after dx = -2 x - 3 x^3 + 8 u.
const SLOW: f64 = 0.06;

/// A state with a stiffening spring follows a stepwise command; either the command or the sensor lags.
pub fn lagged(at_sensor: bool, seed: u64) -> String {
    lagged_by(SLOW, at_sensor, seed)
}

fn lagged_by(lag_time: f64, at_sensor: bool, seed: u64) -> String {
    let mut random = Random::new(seed);
    let (mut state, mut level) = ([0.0, 0.0], 0.0);
    let mut text = String::from("t,x,u\n");
    for (k, t) in grid(1500, FINE).iter().enumerate() {
        if k % 37 == 0 {
            level = random.normal().clamp(-1.5, 1.5);
        }
        let read = state[usize::from(at_sensor)] + 0.005 * random.normal();
        text += &format!("{t},{read:.6},{level}\n");
        let f = |_: f64, &[x, lag]: &[f64; 2]| {
            let drive = if at_sensor { level } else { lag };
            let followed = if at_sensor { x } else { level };
            let law = -2.0 * x - 3.0 * x.powi(3) + 8.0 * drive;
            [law, (followed - lag) / lag_time]
        };
        state = integrate(&f, *t, t + FINE, state);
    }
    text
}

#[test]
fn a_state_that_a_sensor_follows_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let model = "state x\nstate z : hidden\ninput u : hold\nunknown tau in 0.001..10\n\
                 dx = (z - x)/tau\ndz ~ <1, z, z^2, z^3, z^4, u>\n";
    let (run, document) = identify(folder.path(), model, &lagged(true, 7), &[]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    for (term, truth) in [("z", -2.0), ("z^3", -3.0), ("u", 8.0)] {
        near(coefficient(&document, "dz", term), truth, 0.03);
    }
    assert_eq!(coefficient(&document, "dz", "z^2"), 0.0);
    near(
        document["unknowns"][0]["value"].as_f64().unwrap(),
        SLOW,
        0.03,
    );
}

/// The reason about a missing state, with the lines to add.
fn missing(document: &Value) -> (String, Vec<String>) {
    let reasons = document["equations"][0]["reasons"].as_array().unwrap();
    let reason = reasons.iter().find(|r| r["code"] == "missing-state");
    let reason = reason.unwrap_or_else(|| panic!("{reasons:?}"));
    let lines = reason["remedy"]["change"]["model"].as_array().unwrap();
    let lines = lines.iter().map(|l| l.as_str().unwrap().to_string());
    (reason["text"].as_str().unwrap().into(), lines.collect())
}

/// The time constant that a sketch finds for a lag of the input; `None` if the lag is not searched for.
fn sketched_lag(readings: &str) -> Option<f64> {
    let text = "state x\nstate F : hidden\ninput u : hold\nunknown tau in 0.001..10\n\
                dF = (u - F)/tau\ndx ~ <1, x, x^2, x^3, x^4, F>\n";
    let program = Program::compile("lag.sid", text).unwrap();
    let sources = &mut Sources::default();
    let table = data::read("lag.csv", readings.as_bytes(), &Limits::default(), sources).unwrap();
    let (dataset, _) = data::bind(&program.model, &[table], &[], sources);
    let (of, options) = ((&program.model, &program.libraries[..]), Options::default());
    let problem = joint(of.0, of.1, &dataset, &options, &mut Unwatched).unwrap();
    let given = (&dataset, &problem);
    let scope = SearchScope::Sensors;
    let (found, _) = describe_jointly(of, given, scope, &options, &mut Unwatched)?;
    Some(found.unknowns[0].value)
}

#[test]
fn a_lag_is_searched_for_where_some_lag_describes_the_readings_better_than_none() {
    near(sketched_lag(&lagged(false, 8)).unwrap(), SLOW, 0.03);
    // Where the readings follow the command at once, the likeliest lag is the shortest.
    let prompt = lagged_by(5e-4, false, 8);
    assert!(sketched_lag(&prompt).is_none());
}

#[test]
fn a_lag_that_the_model_lacks_is_proposed_where_it_is() {
    let unnamed = "state x\ninput u : hold\ndx ~ <1, x, x^2, x^3, x^4, u>\n";
    for (at_sensor, what) in [(false, "lag of u"), (true, "lag of the sensor of x")] {
        let folder = tempfile::tempdir().unwrap();
        let (run, document) = identify(folder.path(), unnamed, &lagged(at_sensor, 8), &[]);
        assert_eq!(run.status, 3, "{}", run.stdout);
        let (text, lines) = missing(&document);
        assert!(
            text.contains(what) && !text.contains("do not tell"),
            "{text}"
        );
        assert!(text.contains("tau = 0.06"), "{text}");
        assert!(run.words().contains(&lines[0]), "{}", run.stdout);
        let hidden = lines.iter().filter(|l| l.contains(": hidden"));
        assert_eq!(hidden.count(), 1, "{lines:?}");
    }
}

/// An epidemic with only the infectious measured.
fn epidemic(seed: u64) -> String {
    let mut random = Random::new(seed);
    let mut state = [0.999, 0.0, 0.001];
    let mut text = String::from("t,I\n");
    for t in grid(640, 0.25) {
        text += &format!("{t},{:.6}\n", state[2] + 0.0003 * random.normal());
        let f = |_: f64, &[s, e, i]: &[f64; 3]| {
            [-0.5 * s * i, 0.5 * s * i - 0.2 * e, 0.2 * e - 0.1 * i]
        };
        state = integrate(&f, t, t + 0.25, state);
    }
    text
}

#[test]
fn rates_that_can_change_places_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let model = "unknown b in 0.05..5\nunknown s in 0.02..2\nstate I\nstate S, E : hidden\n\
                 dS = -b*S*I\ndE = b*S*I - s*E\ndI ~ known(s*E) + <1, I, I^2>\n";
    let (run, _) = identify(folder.path(), model, &epidemic(9), &[]);
    assert_eq!(run.status, 3, "{}", run.stdout);
    assert!(
        run.words().contains("by other values in the same laws"),
        "{}",
        run.stdout
    );
    let (run, document) = identify(
        folder.path(),
        &model.replace("unknown s in 0.02..2", "let s = 0.2"),
        &epidemic(9),
        &[],
    );
    assert_eq!(run.status, 0, "{}", run.stdout);
    near(coefficient(&document, "dI", "I"), -0.1, 0.05);
}

#[test]
fn an_unread_compartment_is_no_tie() {
    // A drug in the blood, which a tissue takes up and returns; a dose lasts an hour, every eight.
    let (folder, mut random) = (tempfile::tempdir().unwrap(), Random::new(3));
    let (mut state, mut text) = ([0.0, 0.0], String::from("t,c,dose\n"));
    for t in grid(97, 0.25) {
        let dose = if t % 8.0 < 1.0 { 10.0 } else { 0.0 };
        let read = state[0] + 0.09 * random.normal();
        text += &format!("{t},{read},{dose}\n");
        let f = |_: f64, &[c, p]: &[f64; 2]| [dose - 0.8 * c + 0.2 * p, 0.5 * c - 0.2 * p];
        state = integrate(&f, t, t + 0.25, state);
    }
    let model = "state c\nstate p : hidden\ninput dose : hold\ndc ~ <1, c, p, dose>\ndp ~ <c, p>\n";
    let (run, document) = identify(folder.path(), model, &text, &[]);
    assert!(run.stdout.contains("law: passes"), "{}", run.stdout);
    near(coefficient(&document, "dc", "c"), -0.8, 0.05);
    near(coefficient(&document, "dp", "p"), -0.2, 0.15);
}
