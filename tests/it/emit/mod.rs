//! Emitted code is run and compared with our own evaluator (`languages.rs`); text for readers is kept as snapshots.

mod caveats;
mod controllers;
mod events;
mod examples;
mod fmi;
mod languages;
mod parameters;
mod random;
mod reference;
mod systems;

use sidc_emit as emit;
use sidc_system::discovery::{Discovery, UnknownValue};
use sidc_system::result;
use sidc_testing::program::{file, root, sidc};

/// A result with the given variables and equations (target, [(term, coefficient)]).
fn document(
    variables: &[(&str, &str, u8)],
    time: &str,
    equations: &[(&str, &[(&str, f64)])],
) -> Discovery {
    let variables: Vec<_> = variables
        .iter()
        .map(|(name, kind, order)| serde_json::json!({"name": name, "kind": kind, "order": order}))
        .collect();
    let equations: Vec<_> = equations
        .iter()
        .map(|(target, terms)| {
            let terms: Vec<_> = terms
                .iter()
                .map(|(term, c)| serde_json::json!({"term": term, "coefficient": c}))
                .collect();
            serde_json::json!({"target": target, "terms": terms, "status": "pass"})
        })
        .collect();
    let doc = serde_json::json!({
        "sidc_result": 1, "time": time, "variables": variables, "equations": equations
    });
    result::read("R.json", &doc.to_string()).unwrap_or_else(|d| panic!("{}", d.message))
}

/// The system timed in `benches/emitted.rs`.
fn pendulum() -> Discovery {
    let text = file("benches/emitted/pendulum.json");
    result::read("pendulum.json", &text).unwrap_or_else(|d| panic!("{}", d.message))
}

/// Systems that together use every construct of the emitters.
fn systems() -> Vec<(&'static str, Discovery)> {
    let functions = document(
        &[
            ("x", "state", 1),
            ("z", "state", 3),
            ("u", "input", 1),
            ("m", "param", 0),
        ],
        "continuous",
        &[
            (
                "dx",
                &[
                    ("1", -0.3),
                    ("x/m", 1.5),
                    ("sqrt(abs(x))", 2.0),
                    ("sign(x)", -1.0),
                    ("exp(-x^2)*(1 - x)", 0.1),
                    ("abs(x)^0.5", 3.0),
                    ("min(x, u, 0.2)", 1.0),
                    ("max(x, dz)", -2.0),
                    ("x^-3", 1e-3),
                    ("x/(m*(2 + x^2))", 7.0),
                ],
            ),
            (
                "dddz",
                &[
                    ("tanh(ddz)", -1.0),
                    ("log(2 + x^2)", 1.0),
                    ("du*atan(z)", 0.5),
                    ("sinh(0.1*x) ", 1.0),
                    ("cosh(0.1*x)*tan(0.1*z)", 1.0),
                    ("asin(sin(x))*acos(cos(z))", 1.0),
                    ("cos(3*t)", 2.0),
                ],
            ),
        ],
    );
    let hostile = document(
        &[
            ("type", "state", 1),
            ("fn", "state", 1),
            ("state", "state", 1),
            ("θ", "state", 1),
            ("self", "input", 0),
        ],
        "continuous",
        &[
            ("dtype", &[("fn*self", 2.0), ("state", 1.0)]),
            ("dfn", &[("type^2", -1.0)]),
            ("dstate", &[("θ", 4.0)]),
            ("dθ", &[("sin(state)", 1.0)]),
        ],
    );
    let discrete = document(
        &[("y", "state", 0), ("u", "input", 0)],
        "discrete",
        &[(
            "next(y)",
            &[("y", 0.9), ("lag(y, 1)", -0.2), ("u*lag(u, 2)", 0.5)],
        )],
    );
    vec![
        ("pendulum", pendulum()),
        ("functions", functions),
        ("hostile", hostile),
        ("discrete", discrete),
    ]
}

#[test]
fn coupled_rust_reads_well() {
    insta::assert_snapshot!(
        emit::target("rust")
            .unwrap()
            .emit(&pendulum())
            .unwrap()
            .into_text()
            .unwrap()
    );
}

#[test]
fn latex_reads_well() {
    let text: String = systems()
        .iter()
        .map(|(_, d)| {
            emit::target("latex")
                .unwrap()
                .emit(d)
                .unwrap()
                .into_text()
                .unwrap()
        })
        .collect();
    insta::assert_snapshot!(text);
}

/// `SIDC_WRITE_DOCS=1` rewrites the file.
#[test]
fn the_code_that_is_timed_is_the_code_that_is_emitted() {
    let path = "benches/emitted/pendulum.rs";
    let run = sidc(&["export", "benches/emitted/pendulum.json", "--to", "rust"]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    if std::env::var_os("SIDC_WRITE_DOCS").is_some() {
        std::fs::write(root().join(path), &run.stdout).unwrap();
    }
    assert_eq!(file(path), run.stdout);
}

/// A system with unknown constants and their estimates.
fn constants() -> Discovery {
    let mut constants = document(
        &[
            ("x", "state", 1),
            ("u", "input", 0),
            ("K", "unknown", 0),
            ("n", "unknown", 0),
            ("constant", "unknown", 0),
        ],
        "continuous",
        &[(
            "dx",
            &[
                ("(x^2)^n/(K^n + (x^2)^n)", 2.0),
                ("abs(x/K)^(-2*n)", -0.5),
                ("u*tanh(x/K)", 1.5),
                ("exp(-constant*x^2)", 0.3),
            ],
        )],
    );
    let found = [("K", 0.8), ("n", 2.3), ("constant", 1.7)];
    let found = found.map(|(name, value)| UnknownValue::new(name.into(), value, Some(0.01)));
    constants.unknowns = found.to_vec();
    constants
}

#[test]
fn constants_are_arguments_with_the_values_found() {
    let constants = constants();
    for target in [
        "c", "python", "sympy", "matlab", "rust", "text", "jax", "casadi", "julia", "modelica",
        "sbml",
    ] {
        let code = emit::target(target)
            .unwrap()
            .emit(&constants)
            .unwrap()
            .into_text()
            .unwrap();
        insta::assert_snapshot!(format!("constants_{target}"), code);
    }
}

#[test]
fn every_target_reads_well() {
    for target in [
        "c", "python", "sympy", "matlab", "jax", "casadi", "julia", "modelica",
    ] {
        let code = emit::target(target)
            .unwrap()
            .emit(&pendulum())
            .unwrap()
            .into_text()
            .unwrap();
        insta::assert_snapshot!(format!("pendulum_{target}"), code);
    }
}

/// Uncoupled equations are not solved as a system, and only expressions used twice get a name.
#[test]
fn explicit_equations_need_no_solve() {
    let d = document(
        &[("x", "state", 1), ("y", "state", 1)],
        "continuous",
        &[
            ("dx", &[("y", -1.0)]),
            ("dy", &[("x*sin(y)", 2.0), ("dx", 0.5)]),
        ],
    );
    for target in ["rust", "c", "python", "matlab"] {
        let code = emit::target(target)
            .unwrap()
            .emit(&d)
            .unwrap()
            .into_text()
            .unwrap();
        assert!(
            !code.contains("solve(") && !code.contains("solve_2") && !code.contains("solve_1"),
            "{code}"
        );
        assert!(!code.contains("w1"), "{code}");
    }
}

#[test]
fn implicit_equations_read_well() {
    let d = document(
        &[("x", "state", 1)],
        "continuous",
        &[("dx", &[("dx^3", -0.5), ("x", 1.0), ("sin(x)*dx^2", 0.1)])],
    );
    insta::assert_snapshot!(
        emit::target("rust")
            .unwrap()
            .emit(&d)
            .unwrap()
            .into_text()
            .unwrap()
    );
}
