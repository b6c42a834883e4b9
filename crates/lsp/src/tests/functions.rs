//! Functions and families defined in a model, seen from an editor.

use serde_json::Value;

use super::session::{Session, edited};

const MODEL: &str = "state x, v
unknown vs in 0.1..10
let sat(u) = tanh(u/vs)
let pair(u, w) = sat(u)*w
dx ~ <sat(x), pair(x, v), sat v * x>
dv ~ <x, pair(v, 1)>
";

/// The position of the `n`th occurrence of a text, counted from 0.
fn place(text: &str, n: usize) -> (usize, usize) {
    let (at, _) = MODEL.match_indices(text).nth(n).unwrap();
    let line = MODEL[..at].matches('\n').count();
    (line, at - MODEL[..at].rfind('\n').map_or(0, |i| i + 1))
}

fn opened(text: &str) -> Session {
    let mut session = Session::new(&["utf-16"]);
    session.open(text);
    session
}

/// Line and column of each range, from 0.
fn starts(all: &Value) -> Vec<(u64, u64)> {
    let start = |r: &Value| {
        let at = &r["range"]["start"];
        (
            at["line"].as_u64().unwrap(),
            at["character"].as_u64().unwrap(),
        )
    };
    all.as_array().unwrap().iter().map(start).collect()
}

#[test]
fn a_call_leads_to_its_definition_and_the_definition_to_its_calls() {
    let mut session = opened(MODEL);
    assert!(session.diagnostics().is_empty());
    let found = session.at("definition", place("sat v", 0));
    assert_eq!(starts(&Value::Array(vec![found])), [(2, 4)]);
    let found = session.at("references", place("sat(u) =", 0));
    assert_eq!(starts(&found), [(2, 4), (3, 17), (4, 6), (4, 26)]);
    // An argument is known only in its own definition.
    let found = session.at("references", place("u/vs", 0));
    assert_eq!(starts(&found), [(2, 8), (2, 18)]);
    let hover = session.at("hover", place("pair(x", 0));
    let hover = hover["contents"]["value"].as_str().unwrap();
    assert!(
        hover.contains("function that this model defines"),
        "{hover}"
    );
    assert!(hover.contains("let pair(u, w) = sat(u)*w"), "{hover}");
    let hover = session.at("hover", place("w\n", 0));
    let hover = hover["contents"]["value"].as_str().unwrap();
    assert!(hover.contains("argument of the function"), "{hover}");
    assert!(session.end());
}

#[test]
fn functions_and_arguments_are_renamed() {
    let mut session = opened(MODEL);
    for (at, new, wanted) in [
        (place("sat v", 0), "soft", MODEL.replace("sat", "soft")),
        (
            place("u/vs", 0),
            "q",
            MODEL.replace("sat(u) = tanh(u/", "sat(q) = tanh(q/"),
        ),
        (
            place("w)", 0),
            "q",
            MODEL.replace("(u, w) = sat(u)*w", "(u, q) = sat(u)*q"),
        ),
    ] {
        let edit = session.rename(at, new).unwrap();
        let edits = edit["changes"][super::session::URI].as_array().unwrap();
        assert_eq!(edited(MODEL, edits), wanted);
    }
    for (at, new) in [
        (place("u/vs", 0), "x"),
        (place("w)", 0), "u"),
        (place("x, v", 0), "u"),
        (place("sat v", 0), "pair"),
    ] {
        let refused = session.rename(at, new).unwrap_err();
        assert!(refused.contains("is taken"), "{refused}");
    }
    assert!(session.end());
}

#[test]
fn calls_are_offered_with_places_for_their_arguments() {
    let mut session = opened(&MODEL.replace("dv ~ <x, pair(v, 1)>", "dv ~ <x, pa>"));
    let items = session.at("completion", (5, 11));
    let items = items.as_array().unwrap();
    let own = |label: &str| items.iter().find(|i| i["label"] == label);
    assert_eq!(
        own("pair").unwrap()["textEdit"]["newText"],
        "pair(${1:u}, ${2:w})"
    );
    assert!(own("required").is_some());
    assert!(own("w").is_none());
    let items = session.at("completion", (3, 17));
    let items = items.as_array().unwrap();
    assert!(items.iter().any(|i| i["label"] == "w"));
    assert!(session.end());
}

#[test]
fn names_of_a_family_are_those_of_their_range() {
    let text = "state x1..x5\ndx[i] ~ <x[i-1], x[i]>, i = 1..5 cyclic\n";
    let mut session = opened(text);
    assert!(session.diagnostics().is_empty());
    let found = session.at("definition", (1, 9));
    assert_eq!(starts(&Value::Array(vec![found])), [(0, 6)]);
    assert_eq!(
        session.at("definition", (1, 0))["range"]["start"]["line"],
        0
    );
    assert!(session.rename((1, 9), "y").is_err());
    let hover = session.at("hover", (1, 36));
    assert!(
        hover["contents"]["value"]
            .as_str()
            .unwrap()
            .contains("neighbour")
    );
    assert!(session.end());
}
