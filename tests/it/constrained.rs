//! Constrained regression: what constraints improve, where they bind, and what is reported if they cannot hold.

use std::path::Path;

use serde_json::Value;
use sidc::pipeline;
use sidc_lang::source::Sources;

use sidc_testing::hang::ends;
use sidc_testing::program::{Run, error_codes, file, sidc, sidc_in};

const CARTS: &str = "models/two_carts.sid";
const DATA: &str = "models/data/two_carts.csv";

/// The model of two carts without its constraints.
fn free() -> String {
    let text = file(CARTS);
    let lines = text.lines().filter(|l| !l.starts_with("constrain"));
    lines.map(|l| format!("{l}\n")).collect()
}

/// Runs a model with these lines added. Also returns the result document, if there is one.
fn identified(model: &str, more: &str, table: &str) -> (Run, Value) {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    put("m.sid", &format!("{model}{more}"));
    put("d.csv", table);
    let run = sidc_in(
        folder.path(),
        &["identify", "m.sid", "d.csv", "-q", "-o", "r.json"],
    );
    let document = std::fs::read_to_string(folder.path().join("r.json")).unwrap_or_default();
    (run, serde_json::from_str(&document).unwrap_or_default())
}

fn carts(more: &str) -> (Run, Value) {
    identified(&free(), more, &file(DATA))
}

fn term<'v>(document: &'v Value, target: &str, term: &str) -> &'v Value {
    let equations = document["equations"].as_array().unwrap();
    let equation = equations.iter().find(|e| e["target"] == target).unwrap();
    let terms = equation["terms"].as_array().unwrap();
    terms
        .iter()
        .find(|t| t["term"] == term)
        .unwrap_or(&Value::Null)
}

/// The coefficient found; 0 if the term is not in the equation.
fn coefficient(document: &Value, target: &str, name: &str) -> f64 {
    term(document, target, name)["coefficient"]
        .as_f64()
        .unwrap_or(0.0)
}

fn reasons(document: &Value, target: &str) -> Vec<String> {
    let equations = document["equations"].as_array().unwrap();
    let equation = equations.iter().find(|e| e["target"] == target).unwrap();
    let reasons = equation["reasons"].as_array().unwrap();
    let code = |r: &Value| r["code"].as_str().unwrap().to_string();
    reasons.iter().map(code).collect()
}

/// The table with more noise on `ddx1`, drawn with a seed.
fn noisier(seed: u64) -> String {
    let mut state = seed;
    let mut unit = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut out = String::new();
    for line in file(DATA).lines() {
        let mut cells: Vec<String> = line.split(',').map(String::from).collect();
        if let Some(Ok(value)) = cells.get(3).map(|c| c.parse::<f64>()) {
            let noise: f64 = (0..12).map(|_| unit()).sum::<f64>() - 6.0;
            cells[3] = format!("{}", value + 0.8 * noise);
        }
        out.push_str(&format!("{}\n", cells.join(",")));
    }
    out
}

#[test]
fn what_one_sensor_sees_well_helps_the_other() {
    let tied = file(CARTS);
    let (mut with, mut without) = (0.0, 0.0);
    const DRAWS: u64 = 8;
    for seed in 1..=DRAWS {
        let table = noisier(seed);
        let error = |model: &str| {
            let (_, d) = identified(model, "", &table);
            (coefficient(&d, "ddx1", "dx2 - dx1") / 0.2 - 1.0).powi(2)
        };
        with += error(&tied);
        without += error(&free());
    }
    let root = |s: f64| (s / DRAWS as f64).sqrt();
    let (with, without) = (root(with), root(without));
    println!("error of the link's damping in ddx1: {with:.4} tied, {without:.4} free");
    assert!(with < 0.02 && without > 5.0 * with, "{with} {without}");
}

#[test]
fn equalities_hold_to_rounding_and_the_proof_is_of_the_tied_problem() {
    let (_, d) = identified(&file(CARTS), "", &file(DATA));
    for name in ["x2 - x1", "dx2 - dx1"] {
        let (first, second) = (coefficient(&d, "ddx1", name), coefficient(&d, "ddx2", name));
        assert!(
            (first + 0.5 * second).abs() <= 1e-15 * first.abs(),
            "{name}"
        );
    }
    let u = term(&d, "ddx1", "u");
    assert_eq!(u["coefficient"], 1.0);
    assert_eq!(u["standard_error"], 0.0);
    // The better sensor determines the link, so its error in ddx1 is half of that in ddx2.
    let error = |t| term(&d, t, "x2 - x1")["standard_error"].as_f64().unwrap();
    assert!((error("ddx1") / error("ddx2") - 0.5).abs() < 1e-9);
    for e in d["equations"].as_array().unwrap() {
        let proof = &e["evidence"]["certificate"];
        assert_eq!(proof["constrained"], true);
        assert_eq!(proof["optimal"], true, "{proof}");
        assert_eq!(e["reasons"].as_array().unwrap().len(), 0);
    }
}

#[test]
fn a_bound_that_binds_is_said() {
    let (run, d) = carts("constrain coef(ddx1, dx1) >= -0.29\n");
    assert_eq!(run.status, 3, "{}", run.stderr);
    assert_eq!(coefficient(&d, "ddx1", "dx1"), -0.29);
    assert_eq!(reasons(&d, "ddx1"), ["at-bound"]);
    assert!(reasons(&d, "ddx2").is_empty());
    assert!(run.words().contains(
        "coef(ddx1, dx1) >= -0.29 is met only at its bound; the data alone give coef(ddx1, dx1) = -0.29"
    ), "{}", run.stdout);
}

#[test]
fn a_strict_sign_of_a_term_that_the_data_do_not_show_is_said() {
    let (run, d) = carts("constrain coef(ddx1, x1^3) < 0\n");
    assert_eq!(
        (run.status, reasons(&d, "ddx1")),
        (3, vec!["at-bound".into()])
    );
    // Without a strict inequality there is nothing to report.
    let (run, _) = carts("constrain coef(ddx1, x1^3) <= 0\n");
    assert_eq!(run.status, 0, "{}", run.stdout);
}

#[test]
fn a_free_answer_that_obeys_its_constraints_stays_as_it_is() {
    let (plain, free) = carts("");
    let (run, signed) = carts("constrain coef(ddx1, dx1) < 0 < coef(ddx1, u)\n");
    assert_eq!(run.stdout, plain.stdout);
    assert_eq!(signed["equations"], free["equations"]);
}

#[test]
fn a_known_part_counts_in_a_constraint() {
    let model = free().replace(
        "ddx1, ddx2 ~ <1, x1, x1^3, dx1, u>",
        "ddx2 ~ <x1> + link\nddx1 ~ known(u) + <1, x1, x1^3, dx1>",
    );
    let (run, d) = identified(
        &model,
        "constrain coef(ddx1, u) + coef(ddx1, dx1) = 0.7\n",
        &file(DATA),
    );
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    assert!((coefficient(&d, "ddx1", "dx1") + 0.3).abs() < 1e-15);
    let (run, _) = identified(&model, "constrain coef(ddx1, u) <= 0.5\n", &file(DATA));
    assert_eq!(run.status, 1);
    let words = [
        "constraints-conflict",
        "coef(ddx1, u) has 1 from its known part",
    ];
    for w in words {
        assert!(run.stderr.contains(w), "{}", run.stderr);
    }
}

#[test]
fn a_value_far_from_the_data_is_doubted() {
    let (run, d) = carts("constrain coef(ddx1, x1) = -19.1\n");
    assert_eq!(run.status, 3, "{}", run.stderr);
    assert_eq!(coefficient(&d, "ddx1", "x1"), -19.1);
    assert!(reasons(&d, "ddx1").contains(&"constraint-strained".to_string()));
}

/// Models without an answer: exit status 1, nothing on stdout, and this text.
#[test]
fn constraints_that_cannot_hold_are_named() {
    let cases = [
        (
            "conflict",
            "constrain coef(ddx1, u) >= 0\nconstrain coef(ddx2, x2 - x1) = -20\nconstrain coef(ddx1, x2 - x1) = -0.5*coef(ddx2, x2 - x1)\nconstrain 0 < coef(ddx1, x2 - x1) < 9\n",
        ),
        (
            "contradiction",
            "constrain coef(ddx1, u) >= 0\nconstrain coef(ddx2, x2 - x1) = coef(ddx1, x2 - x1)\n",
        ),
        (
            "no_candidate",
            "constrain coef(ddx1, x1^2) = coef(ddx2, u)\n",
        ),
    ];
    for (name, lines) in cases {
        let (run, _) = carts(lines);
        assert_eq!(run.status, 1, "{name}: {}{}", run.stdout, run.stderr);
        assert_eq!(run.stdout, "");
        insta::with_settings!({ omit_expression => true }, {
            insta::assert_snapshot!(format!("constrained_{name}"), run.stderr);
        });
    }
}

#[test]
fn thousands_of_candidates_are_priced_under_constraints() {
    let model = file("models/pendulum.sid");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.sid");
    let identify = |line: &str| -> (Run, Value) {
        std::fs::write(&path, format!("{model}{line}\n")).unwrap();
        let out = folder.path().join("r.json").display().to_string();
        let data = "models/data/pendulum.csv";
        let model = path.display().to_string();
        let run = sidc(&[
            "identify",
            &model,
            data,
            "--samples",
            "120",
            "-q",
            "-o",
            &out,
        ]);
        let text = std::fs::read_to_string(Path::new(&out)).unwrap();
        (run, serde_json::from_str(&text).unwrap())
    };
    let (run, d) =
        identify("constrain coef(ddy, ddtheta*cos theta) = -coef(ddy, dtheta^2*sin theta)");
    assert_eq!(run.status, 0, "{}", run.stdout);
    let (a, b) = (
        coefficient(&d, "ddy", "ddtheta*cos(theta)"),
        coefficient(&d, "ddy", "dtheta^2*sin(theta)"),
    );
    assert!((a + b).abs() <= 1e-15 && (b - 0.1774193548).abs() < 1e-9);
    // With the wrong sign, F = F sin² + F cos² is the way out, and it is proved to have the smallest norm.
    let (run, d) = identify("constrain coef(ddy, F) < 0");
    assert_eq!(
        (run.status, reasons(&d, "ddy")),
        (3, vec!["at-bound".into()])
    );
    for name in ["F*sin(theta)^2", "F*cos(theta)^2"] {
        assert!(
            (coefficient(&d, "ddy", name) - 1.290322581).abs() < 1e-6,
            "{}",
            run.stdout
        );
    }
    let evidence = &d["equations"][0]["evidence"];
    assert_eq!(evidence["certificate"]["of_answer"], true, "{evidence}");
    assert_eq!(evidence["solver"], "clarabel");
}

/// Codes of the errors of a model.
fn errors(text: &str) -> Vec<&'static str> {
    let mut sources = Sources::default();
    let file = sources.add("m.sid", text);
    let (_, found) = pipeline::compile(file, &sources, pipeline::MEMORY);
    error_codes(&found)
}

/// Independent constraints are checked separately; coupled ones up to a number of them. Neither takes long.
#[test]
fn thousands_of_constraints_are_judged_in_time() {
    let states: Vec<String> = (1..=400).map(|i| format!("dx{i} ~ <x1, x{i}>\n")).collect();
    let head = format!("state x1..x400\n{}", states.concat());
    let each = |of: &dyn Fn(usize) -> String| (1..=400).map(of).collect::<String>();
    let apart =
        each(&|i| format!("constrain coef(dx{i}, x1) > 0\nconstrain coef(dx{i}, x1) < 1\n"));
    let errors = |text: String| ends(move || errors(&text));
    assert_eq!(errors(head.clone() + &apart), [""; 0]);
    let against =
        each(&|i| format!("constrain coef(dx{i}, x1) > 1\nconstrain coef(dx{i}, x1) < 0\n"));
    assert_eq!(
        errors(head.clone() + &against),
        ["constraints-conflict"; 10]
    );
    let chain = each(&|i| format!("constrain coef(dx{i}, x1) < coef(dx{}, x1)\n", i % 400 + 1));
    assert_eq!(errors(head + &chain), ["too-large"]);
}
