//! Laws that are all given: their constants are estimated, wrong ones are doubted, and what no readings can tell is refused.

use std::fs;

use serde_json::Value;
use sidc_testing::program::{Run, sidc_in};
use sidc_testing::random::Random;

use crate::disturbed::identify;
use crate::unknown_constants::table;

const PREY: &str =
    "state x, y\nunknown a, b, c, d in 0.01..10\ndx = a*x - b*x*y\ndy = c*x*y - d*y\n";
const TRUTH: [(&str, f64); 4] = [("a", 1.1), ("b", 0.4), ("c", 0.1), ("d", 0.4)];

/// Prey and predators, with noise of a part of four.
fn populations(noise: f64, seed: u64) -> String {
    let mut random = Random::new(seed);
    let law = |_: f64, z: &[f64; 2]| {
        [
            1.1 * z[0] - 0.4 * z[0] * z[1],
            0.1 * z[0] * z[1] - 0.4 * z[1],
        ]
    };
    table("x,y", 600, [10.0, 5.0], &law, |_, z| {
        vec![
            z[0] + 4.0 * noise * random.normal(),
            z[1] + 4.0 * noise * random.normal(),
        ]
    })
}

fn unknown<'a>(found: &'a Value, name: &str) -> &'a Value {
    let all = found["unknowns"].as_array().unwrap();
    all.iter().find(|u| u["name"] == name).unwrap()
}

fn near(found: &Value, name: &str, truth: f64, part: f64) {
    let value = unknown(found, name)["value"].as_f64().unwrap();
    assert!((value / truth - 1.0).abs() < part, "{name}: {value}");
}

fn codes(found: &Value) -> Vec<&str> {
    let equations = found["equations"].as_array().unwrap();
    let reasons = equations.iter().flat_map(|e| e["reasons"].as_array());
    let codes = reasons.flatten().map(|r| r["code"].as_str().unwrap());
    codes.collect()
}

fn refused(model: &str, data: &str) -> Run {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("m.sid"), model).unwrap();
    fs::write(folder.path().join("d.csv"), data).unwrap();
    let run = sidc_in(folder.path(), &["identify", "m.sid", "d.csv"]);
    assert_eq!(run.status, 1, "{}{}", run.stdout, run.stderr);
    run
}

#[test]
fn constants_of_measured_states_are_found_with_their_errors() {
    for (noise, part) in [(0.0, 1e-4), (0.02, 0.02)] {
        let (run, found) = identify(PREY, &populations(noise, 3), &[]);
        assert_eq!(run.status, 0, "{}", run.stdout);
        for (name, truth) in TRUTH {
            near(&found, name, truth, part);
            let [value, error] =
                ["value", "standard_error"].map(|k| unknown(&found, name)[k].as_f64());
            assert!((value.unwrap() - truth).abs() < 4.0 * error.unwrap() + 1e-6);
        }
    }
}

#[test]
fn a_state_that_is_not_measured_is_found_by_runs_from_many_starts() {
    let model = "state x\nstate y : hidden\nunknown a, c, d in 0.01..10\ndx = a*x - x*y\ndy = c*x*y - d*y\n";
    for (noise, part) in [(0.0, 1e-3), (0.02, 0.05)] {
        let (run, found) = identify(model, &populations(noise, 4), &[]);
        assert_eq!(run.status, 0, "{}", run.stdout);
        for (name, truth) in [("a", 1.1), ("c", 0.1), ("d", 0.4)] {
            near(&found, name, truth, part);
        }
    }
}

#[test]
fn wrong_laws_are_doubted_with_or_without_constants() {
    let wrong = PREY.replace("c*x*y", "c*x*x");
    let (run, found) = identify(&wrong, &populations(0.02, 5), &[]);
    assert_eq!(run.status, 3, "{}", run.stdout);
    let failed = found["failed"].as_array().is_some_and(|f| !f.is_empty());
    assert!(
        failed || codes(&found).contains(&"misfit"),
        "{}",
        run.stdout
    );
    let stated =
        |rate: &str| format!("state x, y\ndx = 1.1*x - 0.4*x*y\ndy = 0.1*x*y - {rate}*y\n");
    for noise in [0.0, 0.02] {
        let right = identify(&stated("0.4"), &populations(noise, 6), &[]).0;
        assert_eq!(right.status, 0, "{}", right.stdout);
        let wrong = identify(&stated("0.5"), &populations(noise, 6), &[]).0;
        assert_eq!(wrong.status, 3, "{}", wrong.stdout);
    }
}

/// A map with noise in every step, and a static curve whose other form leaves residuals that follow the input.
#[test]
fn maps_and_curves_are_estimated_by_regression() {
    let mut random = Random::new(7);
    let (mut x, mut rows) = (0.5_f64, String::from("k,x\n"));
    for k in 0..300 {
        rows += &format!("{k},{x}\n");
        x *= (2.1 * (1.0 - x / 3.0) + 0.05 * random.normal()).exp();
    }
    let map = "state x\nunknown r, K in 0.1..10\nnext x = x*exp(r*(1 - x/K))\n";
    let (run, found) = identify(map, &rows, &[]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    near(&found, "r", 2.1, 0.03);
    near(&found, "K", 3.0, 0.03);

    let mut rows = String::from("t,u,y\n");
    for k in 0..300 {
        let u = 3.0 * (7.3 * f64::from(k)).sin();
        let y = 2.5 * (u / 0.8).tanh() + 0.02 * random.normal();
        rows += &format!("{},{u},{y}\n", 0.1 * f64::from(k));
    }
    let curve = "output y\ninput u : hold\nunknown a, k in 0.1..10\ny = a*tanh(u/k)\n";
    let (run, found) = identify(curve, &rows, &[]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    near(&found, "a", 2.5, 0.01);
    near(&found, "k", 0.8, 0.02);
    let (run, found) = identify(&curve.replace("tanh", "atan"), &rows, &[]);
    assert!(
        run.status == 3 && codes(&found).contains(&"coloured-residuals"),
        "{}",
        run.stdout
    );
}

#[test]
fn constants_that_no_readings_can_tell_are_refused_before_the_search() {
    let prey = populations(0.02, 8);
    let cases = [
        (
            "state x, y\nunknown a, b in 0.1..10\ndx = a*b*x - 0.4*x*y\ndy ~ <x*y, y>\n",
            "no readings can tell a: only its product with b acts on what is read",
        ),
        (
            "state x, y\nunknown a, b in 0.1..10\ndx = a/b*x - 0.4*x*y\ndy ~ <x*y, y>\n",
            "only its ratio to b acts",
        ),
        (
            "state x, y\nunknown a, b in 0.1..10\ndx = (a + b)*x - 0.4*x*y\ndy = 0.1*x*y - 0.4*y\n",
            "only a combination of a and b acts",
        ),
        (
            "state x\nstate y : hidden\nunknown a, b, c, d in 0.01..10\ndx = a*x - b*x*y\ndy = c*x*y - d*y\n",
            "no readings can tell b: a hidden state may have any scale beside it",
        ),
        (
            "state x\nstate h : hidden\nunknown tau in 0.1..10\ndh = (x - h)/tau\ndx ~ poly(x; 2)\n",
            "no readings can tell tau: nothing that is read depends on it",
        ),
    ];
    for (model, why) in cases {
        let run = refused(model, &prey);
        assert!(
            run.stderr.contains("error[unidentifiable-constant]") && run.stderr.contains(why),
            "{}",
            run.stderr
        );
    }
}

/// Two lags in a row may change places: other values follow the readings as well, which no local test sees.
#[test]
fn another_optimum_as_good_is_a_tie() {
    let level = |t: f64| [0.2, 1.0, 0.5, 1.4, 0.0, 0.8][(t / 2.0 + 1e-9) as usize % 6];
    let law = |t: f64, z: &[f64; 2]| [(level(t) - z[0]) / 2.0, 0.6 * z[0] - 0.2 * z[1]];
    let mut random = Random::new(9);
    let rows = table("T,u", 800, [0.0, 1.0], &law, |t, z| {
        vec![z[1] + 0.005 * random.normal(), level(t)]
    });
    let model = "state T\nstate H : hidden\ninput u : hold\nunknown tau in 0.2..20\nunknown g, a in 0.02..5\n\
                 dH = (u - H)/tau\ndT = g*H - a*T\n";
    let (run, found) = identify(model, &rows, &[]);
    assert!(
        run.status == 3 && codes(&found).contains(&"tie"),
        "{}",
        run.stdout
    );
}
