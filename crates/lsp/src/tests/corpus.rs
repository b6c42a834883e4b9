//! Every request for every model of the corpus, and models while they are typed.

use std::collections::BTreeMap;

use super::session::{Session, corpus};

#[test]
fn every_model_is_answered_and_named_as_the_compiler_names_it() {
    let mut session = Session::new(&["utf-16"]);
    for (name, text) in corpus() {
        session.open(&text);
        let found = session.diagnostics();
        let faulty = found.iter().any(|d| d["severity"] == 1);
        let wrong = name.starts_with("tests/bad");
        assert!(wrong || !faulty, "{name}: {found:#?}");
        for method in [
            "codeAction",
            "formatting",
            "documentSymbol",
            "semanticTokens/full",
            "inlayHint",
            "foldingRange",
        ] {
            session.whole(method);
        }
        for (line, own) in text.lines().enumerate() {
            for (at, _) in own.char_indices().step_by(5) {
                let place = (line, own[..at].encode_utf16().count());
                session.at("hover", place);
                session.at("completion", place);
                // The references of a declaration include the declaration itself.
                let declared = session.at("definition", place);
                if declared.is_object() {
                    let uses = session.at("references", place);
                    let uses = uses.as_array().unwrap();
                    let there = uses.iter().any(|u| u["range"] == declared["range"]);
                    assert!(there, "{name}: {place:?}");
                }
            }
        }
        if !wrong {
            assert!(
                !session.whole("inlayHint").as_array().unwrap().is_empty(),
                "{name}"
            );
        }
    }
    assert!(session.end());
}

/// While one statement of an otherwise complete model is typed, errors concern this statement, names that it will declare, and what the model lacks without
/// it, but hardly ever other statements.
#[test]
fn mistakes_of_half_typed_text_stay_where_they_are() {
    let mut session = Session::new(&["utf-8"]);
    let (mut texts, mut elsewhere) = (0, 0);
    let mut codes: BTreeMap<String, usize> = BTreeMap::new();
    for (name, text) in corpus()
        .iter()
        .filter(|(name, _)| name.starts_with("models/"))
    {
        let starts: Vec<usize> = text.match_indices('\n').map(|(i, _)| i + 1).collect();
        for line in starts.iter().zip(starts.iter().skip(1)) {
            let (start, end) = (*line.0, *line.1 - 1);
            let own = &text[start..end];
            // Lines of a data block or of a long statement belong to another statement.
            let whole = !own.is_empty() && !own.starts_with([' ', '}', '#']) && !own.ends_with('{');
            for (at, _) in own.char_indices().skip(1).step_by(3).filter(|_| whole) {
                let half = format!("{}{}{}", &text[..start], &own[..at], &text[end..]);
                session.open(&half);
                let number = half[..start].matches('\n').count() as u64;
                let errors: Vec<_> = session
                    .diagnostics()
                    .into_iter()
                    .filter(|d| d["severity"] == 1)
                    .collect();
                let local = |d: &&serde_json::Value| d["range"]["start"]["line"] == number;
                texts += 1;
                for d in errors.iter().filter(|d| !local(d)) {
                    elsewhere += 1;
                    *codes.entry(d["code"].to_string()).or_default() += 1;
                }
                let here = errors.iter().filter(local).count();
                assert!(here <= 3, "{name}:\n{half}\n{errors:#?}");
            }
        }
    }
    // Names of a half-typed declaration are still unknown elsewhere; other errors elsewhere are rare.
    let undeclared = codes.get("\"unknown-signal\"").copied().unwrap_or(0);
    assert!((elsewhere - undeclared) * 50 < texts, "{codes:?}");
    assert!(undeclared * 2 < texts, "{codes:?}");
    assert!(session.end());
}
