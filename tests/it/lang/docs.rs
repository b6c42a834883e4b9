//! The examples of the reference are models: those fenced `sid` compile, those fenced `sid-error` do not.
//!
//! All have the layout of `sidc fmt`.

use super::compiled;

/// The fenced blocks of one kind, with their first line numbers.
fn blocks(text: &str, fence: &str) -> Vec<(usize, String)> {
    let opening = format!("```{fence}");
    let mut out = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((i, line)) = lines.next() {
        if line.trim() == opening {
            let body: Vec<&str> = lines
                .by_ref()
                .map(|(_, l)| l)
                .take_while(|l| l.trim() != "```")
                .collect();
            out.push((i + 2, body.join("\n") + "\n"));
        }
    }
    out
}

fn reference() -> String {
    let path = sidc_testing::program::root().join("docs/language.md");
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn examples_of_the_reference_are_right() {
    let examples = blocks(&reference(), "sid");
    assert!(examples.len() >= 15);
    for (line, text) in examples {
        let (model, _, shown) = compiled("example", &text);
        assert!(model.is_some(), "docs/language.md:{line}\n{text}\n{shown}");
        let formatted = sidc_lang::format(sidc_lang::source::FileId(0), &text).unwrap();
        assert_eq!(formatted, text, "docs/language.md:{line} is not formatted");
    }
}

#[test]
fn counterexamples_of_the_reference_are_wrong() {
    let examples = blocks(&reference(), "sid-error");
    assert!(examples.len() >= 5);
    for (line, text) in examples {
        let (model, _, _) = compiled("example", &text);
        assert!(
            model.is_none(),
            "docs/language.md:{line} should be refused\n{text}"
        );
    }
}
