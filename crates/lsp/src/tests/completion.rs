//! Completions at the cursor, written as `|`.

use serde_json::Value;

use super::session::Session;

/// Labels offered at the `|` in a text, sorted as an editor sorts them.
fn offered(text: &str) -> Vec<String> {
    let items = items(text);
    let mut keyed: Vec<(String, String)> = items
        .iter()
        .map(|i| {
            let text = |key: &str| i[key].as_str().unwrap().to_string();
            (text("sortText"), text("label"))
        })
        .collect();
    keyed.sort();
    keyed.into_iter().map(|(_, label)| label).collect()
}

fn items(text: &str) -> Vec<Value> {
    let at = text.find('|').unwrap();
    let line = text[..at].matches('\n').count();
    let start = text[..at].rfind('\n').map_or(0, |i| i + 1);
    let mut session = Session::new(&["utf-8"]);
    session.open(&text.replacen('|', "", 1));
    let items = session.at("completion", (line, at - start));
    assert!(session.end());
    items.as_array().unwrap().clone()
}

#[test]
fn statements_begin_with_missing_equations_and_keywords() {
    let first = offered("|");
    assert_eq!(first.len(), 16, "{first:?}");
    let more = offered("state x, y : order 2\nddx ~ x\n|");
    assert_eq!(more[0], "ddy ~");
    assert!(!more.contains(&"ddx ~".to_string()));
    assert!(more.contains(&"constrain".to_string()));
    assert_eq!(offered("state x\nst|\ndx ~ x").len(), 16);
}

#[test]
fn attributes_fit_their_declaration() {
    assert_eq!(
        offered("state x : |"),
        ["delay", "hidden", "memory", "noise", "order", "unit"]
    );
    assert_eq!(
        offered("input u : hold, |"),
        ["delay", "noise", "order", "unit"]
    );
    assert_eq!(offered("unknown k in 0..1, |"), ["per run", "unit"]);
    assert_eq!(offered("state x : order 2, hidden, |"), ["unit"]);
    assert_eq!(offered("unknown k : p|"), ["per run", "unit"]);
    assert_eq!(offered("state x|"), [] as [&str; 0], "a name is invented");
    assert_eq!(offered("limit |"), ["degree"]);
    assert_eq!(offered("prefer |"), ["degree", "plain"]);
}

#[test]
fn expressions_offer_names_generators_and_functions() {
    let all = offered("state theta : order 2\ninput F\nlet g = 9.81\nddtheta ~ <sin th|, F>");
    for wanted in [
        "theta", "dtheta", "ddtheta", "F", "g", "poly", "powers", "fourier", "lags", "sin", "tanh",
        "t", "pi", "known",
    ] {
        assert!(all.contains(&wanted.to_string()), "{wanted}");
    }
    assert!(!all.contains(&"state".to_string()));
    // After an open bracket or an operator, the statement continues on the next line.
    for text in ["state x\ndx ~ <1,\n|", "state x\ndx ~ x +\n  |"] {
        assert!(offered(text).contains(&"poly".to_string()), "{text}");
    }
    assert_eq!(offered("state x # |"), [] as [&str; 0]);
}

#[test]
fn a_generator_is_a_snippet() {
    let offered = items("state x\ndx ~ po|");
    let poly = offered.iter().find(|i| i["label"] == "poly").unwrap();
    assert_eq!(poly["insertTextFormat"], 2);
    assert_eq!(poly["textEdit"]["newText"], "poly(${1:atoms}; ${2:degree})");
    assert_eq!(poly["textEdit"]["range"]["start"]["character"], 5);
    // The word before the cursor is replaced, the text after it is not.
    let items = items("state theta\ndtheta ~ <sin th|>");
    let range = &items[0]["textEdit"]["range"];
    assert_eq!(
        [&range["start"]["character"], &range["end"]["character"]],
        [14, 16]
    );
}

#[test]
fn columns_come_from_the_tables_beside_the_model() {
    let unquoted = offered("state x\ndata {\n  x = |\n}\ndx ~ x");
    assert_eq!(
        unquoted[..3],
        ["\"Angle\"", "\"Pos [mm]\"", "\"Time (ms)\""]
    );
    assert!(unquoted.contains(&"unwrap".to_string()) && unquoted.contains(&"none".to_string()));
    assert_eq!(
        offered("state x\ndata {\n  x = \"Po|\n}\ndx ~ x"),
        ["Angle", "Pos [mm]", "Time (ms)", "${1:x}"]
    );
    // A header is inserted verbatim, even if it looks like a snippet.
    let hostile = items("state x\ndata { x = |")
        .into_iter()
        .find(|i| i["label"] == "\"${1:x}\"");
    let hostile = hostile.unwrap();
    assert_eq!(hostile["insertTextFormat"], 1);
    assert_eq!(hostile["textEdit"]["newText"], "\"${1:x}\"");
    let items = items("state x\ndata { x = \"Po|s\" }");
    let edit = &items[0]["textEdit"]["range"];
    assert_eq!(
        [&edit["start"]["character"], &edit["end"]["character"]],
        [12, 15]
    );
    let entries = offered("state x\ninput u\ndata {\n  |\n}\ndx ~ x");
    assert_eq!(entries, ["t", "u", "x", "run", "step"]);
    assert!(offered("state x\ndata { x = \"A\" }\n|").contains(&"dx ~".to_string()));
}

#[test]
fn constraints_offer_targets_and_symmetries_variables() {
    let model = "state x, y : order 2\ninput u\nddx, ddy ~ poly(x, y, u; 2)\n";
    assert_eq!(offered(&format!("{model}constrain coef(|")), ["ddx", "ddy"]);
    assert_eq!(offered(&format!("{model}symmetry |")), ["u", "x", "y"]);
}

#[test]
fn coefficients_offer_the_terms_of_their_equation() {
    let model = "state x : order 2\ninput u\nddx ~ powers(x; 2) + <dx, sin(x)*u>\n";
    let terms = ["1", "dx", "u*sin(x)", "x", "x^2"];
    assert_eq!(
        offered(&format!("{model}constrain coef(ddx, |) < 0")),
        terms
    );
    assert_eq!(offered(&format!("{model}coef(ddx, s|")), terms);
    let two = format!("{model}constrain coef(ddx, x) = 2*coef(ddx, |)");
    assert_eq!(offered(&two), terms);
    let discrete = "state x\ninput u\nnext x ~ <x, u>\nconstrain coef(next x, |) < 1";
    assert_eq!(offered(discrete), ["u", "x"]);
    // Without a library, the parts of terms are offered.
    assert!(offered(&format!("{model}constrain coef(dq, |")).contains(&"sin".to_string()));
}
