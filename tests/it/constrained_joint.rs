//! Constraints in the joint estimate, on noisy readings. Constraints that the answer satisfies change nothing; others are enforced with their cost reported,
//! or rejected.

use serde_json::Value;
use sidc_testing::program::{Run, sidc_in};

/// Readings at even times of a system z' = f(z), with noise of fixed size on the named states, which are the first ones.
struct Simulated {
    table: String,
}

impl Simulated {
    fn new(names: &[&str], start: &[f64], noise: f64, f: &dyn Fn(&[f64]) -> Vec<f64>) -> Simulated {
        let (samples, step, inner) = (300, 0.05, 10);
        let mut seed = 12_345_u64;
        let mut unit = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        let moved = |z: &[f64], d: &[f64], h: f64| -> Vec<f64> {
            z.iter().zip(d).map(|(z, d)| z + h * d).collect()
        };
        let mut table = format!("t,{}\n", names.join(","));
        let mut z = start.to_vec();
        for k in 0..samples {
            let gauss = (0..names.len()).map(|_| (0..12).map(|_| unit()).sum::<f64>() - 6.0);
            let gauss: Vec<f64> = gauss.collect();
            let cells: Vec<String> = (z.iter().zip(gauss))
                .map(|(z, g)| format!("{}", z + noise * g))
                .collect();
            table.push_str(&format!("{},{}\n", k as f64 * step, cells.join(",")));
            for _ in 0..inner {
                let h = step / f64::from(inner);
                let a = f(&z);
                let b = f(&moved(&z, &a, 0.5 * h));
                let c = f(&moved(&z, &b, 0.5 * h));
                let d = f(&moved(&z, &c, h));
                z = (0..z.len())
                    .map(|i| z[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
                    .collect();
            }
        }
        Simulated { table }
    }

    fn identified(&self, model: &str, constraints: &str) -> (Run, Value) {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        put("m.sid", &format!("{model}{constraints}"));
        put("d.csv", &self.table);
        let run = sidc_in(
            folder.path(),
            &["identify", "m.sid", "d.csv", "-q", "-o", "r.json"],
        );
        let document = std::fs::read_to_string(folder.path().join("r.json")).unwrap_or_default();
        (run, serde_json::from_str(&document).unwrap_or_default())
    }
}

const PREY: &str = "state x, y\ndx, dy ~ poly(x, y; 2)\n";

/// Lotka and Volterra's predator and prey; prey eaten becomes predators.
fn prey() -> Simulated {
    Simulated::new(&["x", "y"], &[2.0, 1.0], 0.02, &|z| {
        let eaten = 0.8 * z[0] * z[1];
        vec![z[0] - eaten, eaten - 1.2 * z[1]]
    })
}

fn equation<'v>(document: &'v Value, target: &str) -> &'v Value {
    let mut all = document["equations"].as_array().unwrap().iter();
    all.find(|e| e["target"] == target).unwrap()
}

/// Coefficient and standard error of a term; zero if it is absent.
fn term(document: &Value, target: &str, name: &str) -> (f64, f64) {
    let mut terms = equation(document, target)["terms"]
        .as_array()
        .unwrap()
        .iter();
    let found = terms.find(|t| t["term"] == name);
    let number = |key: &str| found.and_then(|t| t[key].as_f64()).unwrap_or(0.0);
    (number("coefficient"), number("standard_error"))
}

fn reasons(document: &Value, target: &str) -> Vec<(String, String)> {
    let all = equation(document, target)["reasons"].as_array().unwrap();
    let text = |r: &Value, key: &str| r[key].as_str().unwrap().to_string();
    all.iter()
        .map(|r| (text(r, "code"), text(r, "text")))
        .collect()
}

fn assert_joint(document: &Value) {
    for e in document["equations"].as_array().unwrap() {
        assert!(e["evidence"]["together"].is_object(), "{e}");
    }
}

/// Terms with their coefficients and standard errors, to the last digit.
fn numbers(document: &Value) -> Vec<(Value, Value, Value)> {
    let equations = document["equations"].as_array().unwrap().iter();
    let terms = equations.flat_map(|e| e["terms"].as_array().unwrap());
    let of = |t: &Value| {
        let get = |key: &str| t[key].clone();
        (get("term"), get("coefficient"), get("standard_error"))
    };
    terms.map(of).collect()
}

#[test]
fn what_the_answer_obeys_changes_no_digit() {
    let data = prey();
    let (_, free) = data.identified(PREY, "");
    assert_joint(&free);
    for constraints in [
        "constrain coef(dx, x) > 0\nconstrain coef(dx, x*y) < 0\n",
        "constrain 0.5 <= coef(dx, x) <= 2\n",
        "constrain coef(dx, y^2) = 0\n",
        "constrain coef(dx, x*y) + 2*coef(dy, x*y) >= 0\n",
    ] {
        let (run, signed) = data.identified(PREY, constraints);
        assert_joint(&signed);
        assert_eq!(numbers(&signed), numbers(&free), "{constraints}");
        assert!(!run.stderr.contains("weaker-method"), "{}", run.stderr);
    }
}

#[test]
fn what_one_loses_the_other_gains() {
    let data = prey();
    let (_, free) = data.identified(PREY, "");
    let (_, tied) = data.identified(PREY, "constrain coef(dx, x*y) = -coef(dy, x*y)\n");
    assert_joint(&tied);
    let ((a, error), (b, same)) = (term(&tied, "dx", "x*y"), term(&tied, "dy", "x*y"));
    assert!((a + b).abs() <= 1e-12 * b && a < 0.0, "{a} {b}");
    assert!((error / same - 1.0).abs() < 1e-9, "{error} {same}");
    let (c, d) = (term(&free, "dx", "x*y"), term(&free, "dy", "x*y"));
    // An estimate from both equations is better than one from each.
    assert!(error < c.1 && error < d.1, "{error} {} {}", c.1, d.1);
    assert!((b - 0.8).abs() < 4.0 * error, "{b} {error}");
    for target in ["dx", "dy"] {
        let told = reasons(&tied, target);
        assert!(
            told.iter().all(|(c, _)| c != "constraint-strained"),
            "{told:?}"
        );
    }
}

#[test]
fn a_known_value_is_kept() {
    let (_, d) = prey().identified(
        PREY,
        "constrain coef(dx, x) = 1\nconstrain coef(dy, y) <= 0\n",
    );
    assert_joint(&d);
    assert_eq!(term(&d, "dx", "x"), (1.0, 0.0));
    let (a, error) = term(&d, "dx", "x*y");
    assert!((a + 0.8).abs() < 4.0 * error, "{a} {error}");
}

#[test]
fn a_bound_that_binds_is_met_and_named_with_its_cost() {
    let data = prey();
    let (_, free) = data.identified(PREY, "");
    let (a, error) = term(&free, "dx", "x");
    let bound = ((a - 2.0 * error) * 1e4).round() / 1e4;
    let (run, d) = data.identified(PREY, &format!("constrain coef(dx, x) <= {bound}\n"));
    assert_joint(&d);
    assert_eq!(run.status, 3, "{}", run.stderr);
    assert_eq!(term(&d, "dx", "x"), (bound, 0.0));
    let told = reasons(&d, "dx");
    let text = &told.iter().find(|(c, _)| c == "at-bound").unwrap().1;
    let words = format!("coef(dx, x) <= {bound} is met only at its bound; the data alone give");
    assert!(text.starts_with(&words) && text.contains("χ²"), "{text}");
}

#[test]
fn a_sign_against_the_data_is_doubted_where_other_terms_fit_and_refused_where_none_do() {
    let data = prey();
    let sign = "constrain coef(dx, x) <= 0\n";
    // Five terms of a rich library compensate for the missing growth.
    let (run, d) = data.identified(PREY, sign);
    assert_eq!(run.status, 3, "{}", run.stdout);
    assert_joint(&d);
    assert!(term(&d, "dx", "x").0 <= 0.0);
    let told = reasons(&d, "dx");
    assert!(
        told.iter().any(|(c, _)| c == "constraint-strained"),
        "{told:?}"
    );
    let (run, _) = data.identified("state x, y\ndx, dy ~ <x, y, x*y>\n", sign);
    assert_eq!(run.status, 1, "{}", run.stdout);
    assert_eq!(run.stdout, "");
    let words = [
        "constraints-contradict-data",
        "coef(dx, x) <= 0; the data give coef(dx, x) = ",
    ];
    for w in words {
        assert!(run.stderr.contains(w), "{}", run.stderr);
    }
}

#[test]
fn a_pendulum_keeps_its_signs_and_its_order() {
    let model =
        "state theta : order 2\nddtheta ~ <1, theta, dtheta, sin theta, dtheta*abs(dtheta)>\n";
    let data = Simulated::new(&["theta"], &[1.5, 0.0], 0.01, &|z| {
        vec![z[1], -9.0 * z[0].sin() - 0.3 * z[1]]
    });
    let (_, free) = data.identified(model, "");
    let signs = "constrain coef(ddtheta, dtheta) <= 0\nconstrain coef(ddtheta, sin theta) < 0\n";
    let (_, signed) = data.identified(model, signs);
    assert_joint(&signed);
    assert_eq!(numbers(&signed), numbers(&free));
    // A value that no free search gives.
    let (_, known) = data.identified(model, "constrain coef(ddtheta, sin theta) = -9\n");
    assert_joint(&known);
    assert_eq!(term(&known, "ddtheta", "sin(theta)"), (-9.0, 0.0));
    let (damping, error) = term(&known, "ddtheta", "dtheta");
    assert!((damping + 0.3).abs() < 4.0 * error, "{damping} {error}");
}

#[test]
fn noisy_readings_that_go_another_way_are_told_so() {
    let (run, _) = prey().identified(PREY, "");
    assert!(!run.stderr.contains("weaker-method"), "{}", run.stderr);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.sid"), PREY).unwrap();
    std::fs::write(folder.path().join("d.csv"), prey().table).unwrap();
    let run = sidc_in(
        folder.path(),
        &["identify", "m.sid", "d.csv", "--samples", "100"],
    );
    assert!(
        run.stderr.contains("warning[weaker-method]")
            && run.stderr.contains("rows are to be drawn"),
        "{}",
        run.stderr
    );
}
