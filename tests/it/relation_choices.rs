//! Other forms of the relations of coupled equations: what is printed and stored, and that the equations are kept.

use std::fmt::Write;

use serde_json::Value;

use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, sidc_in};

const STEP: f64 = 0.02;

/// A cart on springs that carries another; x2 is relative to the first. By Runge–Kutta, with all signals measured.
fn carts() -> String {
    let accelerations = |z: &[f64; 4], u: f64| {
        let [x1, x2, v1, v2] = *z;
        let first = -20.0 * x1 - 0.3 * v1 + u + 12.0 * x2 + 0.2 * v2;
        [first, -first - 24.0 * x2 - 0.4 * v2]
    };
    let rates = |z: &[f64; 4], u: f64| {
        let [a, b] = accelerations(z, u);
        [z[2], z[3], a, b]
    };
    let ahead = |z: &[f64; 4], k: &[f64; 4], h: f64| std::array::from_fn(|i| z[i] + h * k[i]);
    let mut random = Random::new(4);
    let (mut z, mut u) = ([0.0; 4], 0.0);
    let mut text = "t,x1,x2,dx1,dx2,ddx1,ddx2,u\n".to_string();
    for row in 0..300 {
        if row % 20 == 0 {
            u = 6.0 * random.uniform() - 3.0;
        }
        let [a, b] = accelerations(&z, u);
        let [x1, x2, v1, v2] = z;
        writeln!(
            text,
            "{},{x1},{x2},{v1},{v2},{a},{b},{u}",
            STEP * f64::from(row)
        )
        .unwrap();
        let h = STEP / 4.0;
        for _ in 0..4 {
            let a = rates(&z, u);
            let b = rates(&ahead(&z, &a, h / 2.0), u);
            let c = rates(&ahead(&z, &b, h / 2.0), u);
            let d = rates(&ahead(&z, &c, h), u);
            for i in 0..4 {
                z[i] += h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
            }
        }
    }
    text
}

const CARTS: &str = "state x1, x2 : order 2
input u : hold
ddx1 ~ <1, x1, x1^3, dx1, x2, x2^3, dx2, u>
ddx2 ~ <1, ddx1, x1, dx1, x2, x2^3, dx2, u>\n";

fn identify(model: &str, more: &[&str]) -> Run {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.sid"), model).unwrap();
    std::fs::write(folder.path().join("d.csv"), carts()).unwrap();
    sidc_in(
        folder.path(),
        &[&["identify", "m.sid", "d.csv", "-q"], more].concat(),
    )
}

/// The force between the carts cancels in the sum of both laws.
#[test]
fn a_sum_of_laws_with_fewer_terms_is_told_and_the_equations_stay() {
    let run = identify(CARTS, &[]);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    let text = &run.stdout;
    for wanted in [
        "ddx1 = -20*x1 - 0.3*dx1 + 12*x2 + 0.2*dx2 + u\nddx2 = -ddx1 - 24*x2 - 0.4*dx2\n",
        "the same relations, with fewer terms (4 instead of 5 in place of that of ddx1, leaves ",
        "\n    ddx1 = -13.3333*x1 - 0.2*dx1 - 0.333333*ddx2 + 0.666667*u\n",
    ] {
        assert!(text.contains(wanted), "no {wanted} in {text}");
    }
    let run = identify(CARTS, &["--json"]);
    let document: Value = serde_json::from_str(&run.stdout).unwrap();
    let law = &document["relations"]["fewer"]["laws"][0];
    assert_eq!(law["replaces"], "ddx1");
    assert_eq!(law["law"]["left"], "ddx1");
    assert_eq!(law["law"]["terms"][2][0], "ddx2");
    let third = law["law"]["terms"][2][1].as_f64().unwrap();
    assert!((third + 1.0 / 3.0).abs() < 1e-9, "{law}");
    assert_eq!(
        document["equations"][0]["terms"].as_array().unwrap().len(),
        5
    );
}

#[test]
fn evidence_says_what_was_searched() {
    let pendulum = ["models/pendulum.sid", "models/data/pendulum.csv"];
    let words = [&["identify", "-q", "--evidence"], &pendulum[..]].concat();
    let text = sidc_testing::program::sidc(&words).stdout;
    assert!(!text.contains("the same relations, with"), "{text}");
    let line = "relations: no laws of fewer terms were found that span the same relations (";
    assert!(text.contains(line), "{text}");
    assert!(
        text.contains("targets: the mass matrix has condition 2.8 along the data"),
        "{text}"
    );
}

/// The relations are stored, read back and shown in the report.
#[test]
fn the_report_of_a_result_says_it_too() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.sid"), CARTS).unwrap();
    std::fs::write(folder.path().join("d.csv"), carts()).unwrap();
    let run = |words: &[&str]| {
        let run = sidc_in(folder.path(), words);
        assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    };
    run(&["identify", "m.sid", "d.csv", "-q", "-o", "r.json"]);
    run(&["report", "r.json", "d.csv", "-q", "-o", "r.html"]);
    let page = std::fs::read_to_string(folder.path().join("r.html")).unwrap();
    assert!(page.contains("the same relations, with fewer terms (4 instead of 5"));
    assert!(page.contains("ddx1 = -13.3333*x1 - 0.2*dx1 - 0.333333*ddx2 + 0.666667*u"));
}
