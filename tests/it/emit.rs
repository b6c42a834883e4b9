//! Emitted code is compiled, run, and compared with our own evaluator; LaTeX is read by people, so it is a snapshot.

use std::fs;
use std::process::Command;

use sidc::discover::{Discovery, Form};
use sidc::emit;
use sidc::result;

/// A result document with the given variables and equations: (target, [(term, coefficient)]).
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

fn pendulum() -> Discovery {
    document(
        &[("y", "state", 2), ("theta", "state", 2), ("F", "input", 0)],
        "continuous",
        &[
            (
                "ddy",
                &[
                    ("F", 1.290_322_580_645_161_3),
                    ("dy", -0.064_516_129_032_258_06),
                    ("ddtheta*cos(theta)", -0.177_419_354_838_709_7),
                    ("dtheta^2*sin(theta)", 0.177_419_354_838_709_7),
                ],
            ),
            (
                "ddtheta",
                &[
                    ("dtheta", -0.145_454_545_454_545_45),
                    ("sin(theta)", -19.6),
                    ("ddy*cos(theta)", -2.0),
                ],
            ),
        ],
    )
}

/// Systems that between them use every construct of the emitters.
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

/// Deterministic points in ±1.5.
fn point(len: usize, seed: &mut u64) -> Vec<f64> {
    (0..len)
        .map(|_| {
            *seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            3.0 * ((*seed >> 11) as f64 / (1u64 << 53) as f64) - 1.5
        })
        .collect()
}

struct Call {
    code: String,
    expected: Vec<f64>,
}

/// Calls of the emitted function with literal arguments, and what our evaluator says.
fn calls(module: &str, d: &Discovery) -> Vec<Call> {
    let form = Form::new(d);
    let function = if d.discrete { "next" } else { "derivatives" };
    let mut seed = 17;
    (0..20)
        .map(|_| {
            let mut groups = [&form.state, &form.inputs, &form.params, &form.history]
                .map(|g| point(g.len(), &mut seed));
            // A parameter is a mass or a length: away from zero.
            groups[2].iter_mut().for_each(|p| *p = 1.0 + p.abs());
            let t = point(1, &mut seed)[0];
            let arguments: String = groups
                .iter()
                .enumerate()
                .filter(|(i, g)| *i == 0 || !g.is_empty())
                .map(|(_, g)| format!(", &{g:?}"))
                .collect();
            let [x, u, p, h] = &groups;
            Call {
                code: format!("show(&{module}::{function}({t:?}{arguments}));"),
                expected: form.rates_at(t, x, u, p, h).unwrap(),
            }
        })
        .collect()
}

#[test]
fn emitted_rust_agrees_with_the_evaluator() {
    let folder = tempfile::tempdir().unwrap();
    let mut program = String::from(
        "fn show(v: &[f64]) { let t: Vec<String> = v.iter().map(|x| format!(\"{x:e}\")).collect(); println!(\"{}\", t.join(\" \")); }\n",
    );
    let mut all = Vec::new();
    for (name, d) in systems() {
        let code = emit::target("rust").unwrap().emit(&d).unwrap();
        program.push_str(&format!("mod {name} {{\n{code}\n}}\n"));
        all.extend(calls(name, &d));
    }
    program.push_str("fn main() {\n");
    all.iter()
        .for_each(|c| program.push_str(&format!("    {}\n", c.code)));
    program.push_str("}\n");
    let source = folder.path().join("emitted.rs");
    let binary = folder.path().join("emitted");
    fs::write(&source, &program).unwrap();
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let built = Command::new(rustc)
        .args(["--edition", "2021", "-D", "warnings", "-o"])
        .arg(&binary)
        .arg(&source)
        .output()
        .unwrap();
    assert!(
        built.status.success(),
        "{}\n{program}",
        String::from_utf8_lossy(&built.stderr)
    );
    let output = Command::new(&binary).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text.lines().count(), all.len());
    for (line, call) in text.lines().zip(&all) {
        let got: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
        assert_eq!(got.len(), call.expected.len());
        for (a, b) in got.iter().zip(&call.expected) {
            let same = (a - b).abs() <= 1e-12 * (1.0 + b.abs()) || (a.is_nan() && b.is_nan());
            assert!(same, "{a} is not {b} in {}", call.code);
        }
    }
}

#[test]
fn coupled_rust_reads_well() {
    insta::assert_snapshot!(emit::target("rust").unwrap().emit(&pendulum()).unwrap());
}

#[test]
fn latex_reads_well() {
    let text: String = systems()
        .iter()
        .map(|(_, d)| emit::target("latex").unwrap().emit(d).unwrap())
        .collect();
    insta::assert_snapshot!(text);
}

#[test]
fn equations_that_cannot_be_solved_for_their_target_say_so() {
    let d = document(
        &[("x", "state", 1)],
        "continuous",
        &[("dx", &[("dx^2", 1.0), ("x", 1.0)])],
    );
    let why = emit::target("rust").unwrap().emit(&d).unwrap_err();
    assert!(
        why.contains("not linear in their highest derivatives"),
        "{why}"
    );
}
