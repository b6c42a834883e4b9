//! Included files, seen from an editor.

use serde_json::Value;

use super::session::Session;

fn opened(text: &str) -> Session {
    let mut session = Session::new(&["utf-16"]);
    session.open(text);
    session
}

fn labels(items: &Value) -> Vec<String> {
    let items = items.as_array().unwrap().iter();
    items
        .map(|i| i["label"].as_str().unwrap().to_string())
        .collect()
}

#[test]
fn names_of_an_included_file_are_known() {
    let mut session = opened("include \"rig.sid\"\ndvel ~ <pos, u>\n\n");
    assert_eq!(session.diagnostics(), Vec::<Value>::new());
    let equations = labels(&session.at("completion", (2, 0)));
    assert!(equations.contains(&"dpos ~".to_string()), "{equations:?}");
    assert!(!equations.contains(&"dvel ~".to_string()), "{equations:?}");
    let terms = labels(&session.at("completion", (1, 13)));
    assert!(
        terms.contains(&"g".to_string()) && terms.contains(&"dpos".to_string()),
        "{terms:?}"
    );
}

#[test]
fn what_is_wrong_in_an_included_file_is_told_where_it_is_included() {
    let mut session = opened("# a rig\ninclude \"faulty.sid\"\ndvel ~ <pos, g>\n");
    let found = session.diagnostics();
    assert_eq!(found.len(), 1, "{found:#?}");
    let line = &found[0]["range"]["start"]["line"];
    assert_eq!(line, 1);
    let text = found[0]["message"].as_str().unwrap();
    assert!(text.starts_with("in `faulty.sid`: "), "{text}");
    // An error in an included file cannot be fixed in this one.
    assert_eq!(session.whole("codeAction"), Value::Array(Vec::new()));
}

#[test]
fn a_file_that_is_not_there_is_one_mistake() {
    let mut session = opened("include \"other.sid\"\ndvel ~ <pos, g>\n");
    let found = session.diagnostics();
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0]["code"], "include");
    let text = found[0]["message"].as_str().unwrap();
    assert!(text.contains("no such file"), "{text}");
}
