//! Required terms are in the answer for every method, doubted if the data do not show them, and rejected if they are impossible.

use serde_json::Value;
use sidc::pipeline::Program;
use sidc_testing::integrate::{grid, integrate};
use sidc_testing::program::sidc_in;
use sidc_testing::random::Random;

use crate::disturbed::identify;

const STEP: f64 = 0.05;

/// An oscillator with a weak cubic spring, x″ = −x − 0.2 ẋ − c x³ + u, read with noise, optionally with its rates.
fn oscillator(cubic: f64, noise: f64, rates: bool) -> String {
    let mut random = Random::new(7);
    let push = |t: f64| 0.8 * (0.9 * t).sin() + 0.5 * (0.37 * t).cos();
    let law = |t: f64, z: &[f64; 2]| {
        let pull = -z[0] - 0.2 * z[1] - cubic * z[0].powi(3);
        [z[1], pull + push(t)]
    };
    let mut text = String::from(if rates { "t,x,dx,ddx,u\n" } else { "t,x,u\n" });
    let mut z = [1.0, 0.0];
    for t in grid(600, STEP) {
        let x = z[0] + noise * random.normal();
        let rate = law(t, &z);
        let push_back = rate[1] + if rates { noise * random.normal() } else { 0.0 };
        text += &match rates {
            true => format!("{t},{x},{},{},{}\n", z[1], push_back, push(t)),
            false => format!("{t},{x},{}\n", push(t)),
        };
        z = integrate(&|t, z: &[f64; 2]| law(t, z), t, t + STEP, z);
    }
    text
}

fn model(required: &str, more: &str) -> String {
    format!("state x : order 2\ninput u : linear\n{more}ddx ~ {required}poly(x, dx; 3) + u\n")
}

fn coefficient(found: &Value, term: &str) -> Option<f64> {
    let terms = found["equations"][0]["terms"].as_array()?;
    let own = terms.iter().find(|t| t["term"] == term)?;
    own["coefficient"].as_f64()
}

fn codes(found: &Value) -> Vec<String> {
    let reasons = found["equations"][0]["reasons"].as_array();
    let reasons = reasons.into_iter().flatten();
    let codes = reasons.map(|r| r["code"].as_str().unwrap().to_string());
    codes.collect()
}

#[test]
fn a_required_term_that_acts_changes_nothing() {
    let data = oscillator(0.3, 0.0, true);
    let (run, with) = identify(&model("required(x^3, u) + ", ""), &data, &[]);
    let (_, without) = identify(&model("", ""), &data, &[]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    assert_eq!(
        with["equations"][0]["terms"],
        without["equations"][0]["terms"]
    );
}

/// With measured rates, clean readings, noisy readings, the weak form, and constraints.
#[test]
fn whatever_the_method_a_required_term_is_in_the_answer() {
    let constrained = "constrain coef(ddx, x) = -coef(ddx, u)\n";
    let cases: [(f64, bool, &[&str], &str); 6] = [
        (0.0, true, &[], ""),
        (0.0, false, &[], ""),
        (0.02, false, &[], ""),
        (0.02, false, &["--method", "weak"], ""),
        (0.02, true, &["--method", "regression"], constrained),
        (0.02, false, &[], constrained),
    ];
    for (noise, rates, more, line) in cases {
        let data = oscillator(0.0, noise, rates);
        let text = format!("{}{line}", model("required(x^3, x^2*dx) + ", ""));
        let (run, found) = identify(&text, &data, more);
        for term in ["x^3", "x^2*dx"] {
            let value = coefficient(&found, term);
            let value = value.unwrap_or_else(|| panic!("{more:?} {line}\n{}", run.stdout));
            assert!(value.abs() < 0.3, "{more:?} {line} {term} {value}");
        }
        for term in ["x", "dx", "u"] {
            assert!(
                coefficient(&found, term).is_some(),
                "{more:?} {line}\n{}",
                run.stdout
            );
        }
        let free = model("", "") + line;
        let (_, free) = identify(&free, &data, more);
        assert_eq!(coefficient(&free, "x^3"), None, "{more:?} {line}");
    }
}

#[test]
fn a_required_term_without_influence_is_told() {
    for (noise, rates, more) in [
        (0.0, true, &[][..]),
        (0.02, false, &[]),
        (0.02, false, &["--method", "weak"]),
    ] {
        let data = oscillator(0.0, noise, rates);
        let (run, found) = identify(&model("required(x^3) + ", ""), &data, more);
        assert_eq!(run.status, 3, "{more:?}\n{}", run.stdout);
        assert!(
            codes(&found).contains(&"better-without".to_string()),
            "{more:?}\n{}",
            run.stdout
        );
        let said = found["equations"][0]["reasons"].to_string();
        assert!(said.contains("this required term acts: x^3"), "{said}");
    }
}

/// An unmeasured lag with an unknown time constant drives the oscillator; the search starts from guessed trajectories.
#[test]
fn beside_hidden_states_and_unknown_constants_a_required_term_is_kept() {
    let mut random = Random::new(3);
    let push = |t: f64| (0.9 * t).sin() + 0.7 * (0.33 * t).cos() + 0.5 * (2.1 * t).sin();
    let law = |t: f64, z: &[f64; 3]| {
        let pull = -2.0 * z[0] - 0.5 * z[1] + 3.0 * z[2];
        [z[1], pull, (push(t) - z[2]) / 0.6]
    };
    let (mut data, mut z) = (String::from("t,x,u\n"), [0.2, 0.0, 0.0]);
    for t in grid(800, STEP) {
        data += &format!("{t},{},{}\n", z[0] + 0.01 * random.normal(), push(t));
        z = integrate(&|t, z: &[f64; 3]| law(t, z), t, t + STEP, z);
    }
    let text = "unknown tau in 0.05..5\nstate x : order 2\nstate F : hidden\ninput u : linear\n\
                dF = (u - F)/tau\nddx ~ required(dx, x^3) + <1, x, F>\n";
    let (run, found) = identify(text, &data, &[]);
    let law = &found["equations"][1]["terms"];
    let terms: Vec<&str> = law
        .as_array()
        .unwrap()
        .iter()
        .map(|t| t["term"].as_str().unwrap())
        .collect();
    assert_eq!(terms, ["x", "dx", "F", "x^3"], "{}", run.stdout);
    assert!(!run.stdout.contains("lost by the search"), "{}", run.stdout);
}

/// Noise hides a weak term: the search omits it, but the model may require it.
#[test]
fn a_term_that_noise_hides_is_kept_where_it_is_required() {
    let data = oscillator(0.0003, 0.05, false);
    let (_, free) = identify(&model("", ""), &data, &[]);
    assert_eq!(coefficient(&free, "x^3"), None);
    let (_, found) = identify(&model("required(x^3) + ", ""), &data, &[]);
    let value = coefficient(&found, "x^3").unwrap();
    assert!(value.abs() < 0.2, "{value}");
}

#[test]
fn of_a_large_library_what_is_required_is_searched_too() {
    let data = oscillator(0.0, 0.0, true);
    let text = "state x : order 2\ninput u : linear\nddx ~ required(x^7*dx^2) + poly(x, dx, u, sin x; 6)\n";
    let (run, found) = identify(text, &data, &[]);
    assert!(coefficient(&found, "x^7*dx^2").is_some(), "{}", run.stdout);
}

#[test]
fn required_terms_alone_are_least_squares() {
    let data = oscillator(0.3, 0.0, true);
    let text = "state x : order 2\ninput u : linear\nddx ~ required(x, dx, x^3, u)\n";
    let (run, found) = identify(text, &data, &[]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    assert!((coefficient(&found, "x^3").unwrap() + 0.3).abs() < 1e-6);
}

#[test]
fn what_cannot_be_required_is_refused() {
    let refused = |text: &str, words: &str| {
        let error = Program::compile("m.sid", text).err();
        let error = error.unwrap_or_else(|| panic!("{text}"));
        assert!(
            error.contains("error[required-term]") && error.contains(words),
            "{error}"
        );
    };
    refused(
        "state x\ndx ~ required(dx, x) + poly(x; 3)\n",
        "the target itself",
    );
    refused(
        "state x\nsymmetry x -> -x\ndx ~ required(x^2) + poly(x; 3)\n",
        "symmetry x",
    );
    refused(
        "state x\nlimit degree 3\ndx ~ required(x^4) + poly(x; 3)\n",
        "degree ≤ 3",
    );
    refused(
        "state x1..x9\ndx1 ~ required(poly(x2..x9; 4)) + x1\n",
        "the limit is 100",
    );
    let per_run = model("required(x^3) + ", "coef(ddx, u) : per run\n");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.sid"), per_run).unwrap();
    std::fs::write(folder.path().join("d.csv"), oscillator(0.1, 0.01, false)).unwrap();
    let run = sidc_in(folder.path(), &["identify", "m.sid", "d.csv"]);
    assert_eq!(run.status, 1, "{}", run.stdout);
    assert!(
        run.stderr.contains("error[per-run]") && run.stderr.contains("terms are required"),
        "{}",
        run.stderr
    );
}

#[test]
fn the_sparsest_fit_is_not_sought_where_terms_are_required() {
    let data = oscillator(0.3, 0.0, true);
    let (run, _) = identify(
        &model("required(x^3) + ", ""),
        &data,
        &["--prove-sparsest", "-v"],
    );
    assert!(
        (run.stdout + &run.stderr).contains("the model requires terms"),
        "no refusal"
    );
}
