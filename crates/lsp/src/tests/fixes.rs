//! Fixes that are offered are correct.

use super::session::{Session, corpus, edited};
use serde_json::{Value, json};

/// A fix removes its error, and adds no error of the same kind.
#[test]
fn every_fix_removes_what_it_is_offered_for() {
    let mut session = Session::new(&["utf-16"]);
    let mut useless = Vec::new();
    let (mut offered, mut helped, mut errors) = (0, 0, 0);
    for (name, text) in corpus() {
        session.open(&text);
        let before = session.diagnostics();
        let actions = session.whole("codeAction");
        let actions = actions.as_array().unwrap().clone();
        for action in &actions {
            let title = action["title"].as_str().unwrap();
            let own = &action["diagnostics"][0];
            let edits = action["edit"]["changes"][super::session::URI]
                .as_array()
                .unwrap();
            let after = edited(&text, edits);
            assert_ne!(after, text, "{name}: {title} changes nothing");
            session.open(&after);
            let now = session.diagnostics();
            let same = |found: &[Value]| {
                found
                    .iter()
                    .filter(|d| d["message"] == own["message"])
                    .count()
            };
            if same(&now) >= same(&before) {
                let message = own["message"].as_str().unwrap();
                useless.push(format!("{name}: {title}\nagainst {message}\nin\n{after}"));
            }
            offered += 1;
        }
        for d in before.iter().filter(|d| d["severity"] == 1) {
            errors += 1;
            let own = |a: &Value| a["diagnostics"][0] == *d;
            helped += usize::from(actions.iter().any(own));
        }
    }
    assert!(session.end());
    assert!(useless.is_empty(), "{}", useless.join("\n----\n"));
    assert!(offered >= 370, "only {offered} fixes in the corpus");
    assert!(
        helped * 20 > errors * 19,
        "only {helped} of {errors} errors have one"
    );
}

/// Editors ask for fixes at the cursor, which is seldom exactly on the wrong word.
#[test]
fn fixes_are_offered_from_anywhere_on_their_line() {
    let mut session = Session::new(&["utf-16"]);
    session.open("state x\nstaet v : order 2\ndx ~ <x>\n");
    let mut offered = |line: usize, character: usize| {
        let cursor = json!({ "line": line, "character": character });
        let params = json!({
            "textDocument": { "uri": super::session::URI },
            "range": { "start": cursor, "end": cursor },
            "context": { "diagnostics": [] },
        });
        let actions = session.ask("textDocument/codeAction", params).unwrap();
        actions[0]["title"].as_str().map(str::to_string)
    };
    let fix = Some("replace `staet` by `state`".to_string());
    assert_eq!([offered(1, 0), offered(1, 17)], [fix.clone(), fix]);
    assert_eq!([offered(0, 7), offered(2, 0)], [None, None]);
    assert!(session.end());
}

#[test]
fn libraries_are_mended_where_they_stand() {
    let cases = [
        ("constrain coef(dx, x^4) < 0", "poly(x; 3) + <x^4>"),
        ("coef(dx, x^5) : per run", "poly(x; 3) + <x^5>"),
        ("limit degree 9", "poly(x; 3)"),
    ];
    for (line, library) in cases {
        let written = match line.starts_with("limit") {
            true => "poly(x; 3) - <x^5, x^7>",
            false => "poly(x; 3)",
        };
        let text = format!("state x\ndx ~ {written}\n{line}\n");
        let mut session = Session::new(&["utf-16"]);
        session.open(&text);
        let actions = session.whole("codeAction");
        let edits = actions[0]["edit"]["changes"][super::session::URI].clone();
        let after = edited(&text, edits.as_array().unwrap());
        assert_eq!(after, format!("state x\ndx ~ {library}\n{line}\n"));
        session.open(&after);
        let errors = session.diagnostics();
        assert!(errors.iter().all(|d| d["severity"] != 1), "{errors:?}");
    }
}
