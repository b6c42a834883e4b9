//! Result documents that `identify` did not write are rejected with a message and never run as something else.

use sidc_emit as emit;
use sidc_system::result;

fn document(variables: &str, target: &str, terms: &str) -> String {
    format!(
        r#"{{"sidc_result": 1, "variables": [{variables}], "equations": [{{"target": "{target}", "terms": [{terms}], "status": "pass"}}]}}"#
    )
}

const X: &str = r#"{"name": "x", "kind": "state", "order": 2}"#;

/// The code of the rejection, if there is one.
fn refusal(text: &str) -> Option<&'static str> {
    result::read("r.json", text).err().map(|d| d.code)
}

#[test]
fn names_and_terms_cannot_smuggle_statements() {
    let one = r#"{"term": "x", "coefficient": 2.0}"#;
    assert_eq!(refusal(&document(X, "ddx", one)), None);
    let newline = r#"{"name": "x\nstate y", "kind": "state", "order": 1}"#;
    let kind = r#"{"name": "x", "kind": "let q = 3\nstate", "order": 1}"#;
    for variables in [newline, kind, r#"{"name": "", "kind": "state"}"#] {
        assert_eq!(
            refusal(&document(variables, "dx", one)),
            Some("result-damaged"),
            "{variables}"
        );
    }
    for term in [
        "x); import os",
        "x> + <x",
        "x, x",
        "x # y",
        "x\\nddx ~ <1",
        "known(x)",
        "",
        "fn",
    ] {
        let terms = format!(r#"{{"term": "{term}", "coefficient": 2.0}}"#);
        assert_eq!(
            refusal(&document(X, "ddx", &terms)),
            Some("result-damaged"),
            "{term}"
        );
    }
    for coefficient in ["null", "\"1\"", "[1]"] {
        let terms = format!(r#"{{"term": "x", "coefficient": {coefficient}}}"#);
        assert_eq!(
            refusal(&document(X, "ddx", &terms)),
            Some("result-damaged"),
            "{coefficient}"
        );
    }
}

#[test]
fn time_and_equations_are_of_one_kind() {
    let term = r#"{"term": "x", "coefficient": 0.5}"#;
    let x = r#"{"name": "x", "kind": "state", "order": 1}"#;
    let (continuous, sampled) = (document(x, "dx", term), document(x, "next(x)", term));
    let discrete = |text: &str| text.replacen('{', r#"{"time": "discrete", "#, 1);
    assert_eq!(refusal(&continuous), None);
    assert_eq!(refusal(&discrete(&sampled)), None);
    for (text, kind) in [(sampled, "continuous"), (discrete(&continuous), "discrete")] {
        let refused = result::read("r.json", &text).unwrap_err();
        let words = format!("its time is {kind}, and it has an equation for a");
        assert!(refused.message.contains(&words), "{}", refused.message);
    }
}

#[test]
fn an_output_may_contain_the_highest_derivative() {
    let text = r#"{"sidc_result": 1,
        "variables": [{"name": "x", "kind": "state", "order": 2}, {"name": "a", "kind": "output"}],
        "equations": [
            {"target": "ddx", "terms": [{"term": "x", "coefficient": -4.0}], "status": "pass"},
            {"target": "a", "terms": [{"term": "ddx", "coefficient": 0.1}], "status": "pass"}]}"#;
    let discovery = result::read("r.json", text).unwrap();
    let code = emit::target("rust")
        .unwrap()
        .emit(&discovery)
        .unwrap()
        .into_text()
        .unwrap();
    let (_, outputs) = code.split_once("fn outputs").unwrap();
    assert!(
        outputs.contains("let ddx = -4.0 * x;\n    [0.1 * ddx]"),
        "{code}"
    );
}
