//! One wrong model per file in tests/bad, with the message that its author reads.
//!
//! A new code needs a file there and a line in docs/diagnostics.md.

use std::collections::BTreeSet;

use super::{compiled, texts_in};

#[test]
fn every_wrong_model_has_its_golden_text() {
    let folder = sidc_testing::program::root().join("tests/bad");
    let texts = texts_in("tests/bad");
    assert!(texts.len() >= 45, "only {} files in tests/bad", texts.len());
    for (name, text) in texts {
        let (model, found, shown) = compiled(&format!("{name}.sid"), &text);
        let has_error = found.iter().any(|d| d.is_error());
        assert_eq!(
            model.is_none(),
            has_error,
            "{name}: a model exists if and only if there is no error"
        );
        assert!(!found.is_empty(), "{name}: nothing was found");
        let golden = format!("SOURCE\n{text}\nDIAGNOSTICS\n{shown}");
        insta::with_settings!({
            snapshot_path => folder.clone(),
            prepend_module_to_snapshot => false,
            omit_expression => true,
        }, {
            insta::assert_snapshot!(name.clone(), golden);
        });
    }
}

#[test]
fn every_error_shows_a_place() {
    for (name, text) in texts_in("tests/bad") {
        for d in compiled(&name, &text).1 {
            let placed = d
                .labels
                .iter()
                .any(|l| l.primary && l.span.end <= text.len());
            assert!(placed, "{name}: `{}` has no place in the text", d.code);
        }
    }
}

#[test]
fn every_error_offers_a_way_out() {
    for (name, text) in texts_in("tests/bad") {
        for d in compiled(&name, &text).1.iter().filter(|d| d.is_error()) {
            let meant = d.labels.iter().any(|l| l.text.contains("did you mean"));
            assert!(
                meant || d.help.is_some(),
                "{name}: `{}` offers no fix",
                d.code
            );
        }
    }
}

/// All codes that the program can print, read from its source.
fn codes_in_source() -> BTreeSet<String> {
    let mut out = BTreeSet::new();
    let mut folders = ["src", "crates"]
        .map(|f| sidc_testing::program::root().join(f))
        .to_vec();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|x| x == "rs") {
                codes_in(&std::fs::read_to_string(path).unwrap(), &mut out);
            }
        }
    }
    out
}

fn codes_in(source: &str, out: &mut BTreeSet<String>) {
    for call in [
        "Diagnostic::error(",
        "Diagnostic::warning(",
        "Diagnostic::note(",
    ] {
        for (i, _) in source.match_indices(call) {
            let rest = source[i + call.len()..].trim_start();
            if let Some(code) = rest.strip_prefix('"').and_then(|r| r.split('"').next()) {
                out.insert(code.to_string());
            }
        }
    }
}

#[test]
fn every_code_is_documented() {
    let table =
        std::fs::read_to_string(sidc_testing::program::root().join("docs/diagnostics.md")).unwrap();
    let missing: Vec<String> = codes_in_source()
        .into_iter()
        .filter(|code| !table.contains(&format!("| `{code}` |")))
        .collect();
    assert!(
        missing.is_empty(),
        "docs/diagnostics.md has no line for these codes; add one for each: | `code` | what it means |\n{missing:#?}"
    );
}

#[test]
fn codes_are_kebab_case() {
    for code in codes_in_source() {
        let fits = code
            .chars()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-');
        assert!(fits, "`{code}` is not kebab-case");
    }
}
