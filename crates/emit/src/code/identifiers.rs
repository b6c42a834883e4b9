//! Names that are safe in a target language: as identifiers, in comments, in strings.
//!
//! In: names as users wrote them. Out: text that no language takes for syntax. Reserved words come from the caller.

use std::collections::{BTreeMap, BTreeSet};

use sidc_lang::term::Signal;

/// Length after which an identifier is cut. MATLAB reads 63 characters, and numbers may be appended.
const MAX_IDENTIFIER: usize = 40;

/// One ASCII identifier per signal; distinct signals get distinct identifiers.
#[derive(Clone)]
pub(crate) struct Identifiers {
    by_signal: BTreeMap<Signal, String>,
    taken: BTreeSet<String>,
}

impl Identifiers {
    /// `reserved`: keywords of the language and names in the emitted code.
    pub fn new<'a>(
        signals: impl IntoIterator<Item = (Signal, String)>,
        reserved: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let mut identifiers = Identifiers {
            by_signal: BTreeMap::new(),
            taken: reserved.into_iter().map(String::from).collect(),
        };
        for (signal, name) in signals {
            let name = identifiers.fresh(&name);
            identifiers.by_signal.insert(signal, name);
        }
        identifiers
    }

    pub fn get(&self, s: Signal) -> &str {
        self.by_signal.get(&s).map_or("missing", String::as_str)
    }

    /// An unused identifier, as close to `name` as possible.
    pub fn fresh(&mut self, name: &str) -> String {
        let base = ascii(name);
        let mut candidate = base.clone();
        let mut k = 1;
        while self.taken.contains(&candidate) {
            k += 1;
            candidate = format!("{base}_{k}");
        }
        self.taken.insert(candidate.clone());
        candidate
    }
}

/// Letters, digits and single underscores; any other character becomes its code point.
pub(crate) fn ascii(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
        if out.len() > MAX_IDENTIFIER {
            break;
        }
        if c.is_ascii_alphanumeric() {
            out.push(c);
        } else if matches!(c, '_' | '(' | ')' | ',' | ' ') {
            if !out.ends_with('_') {
                out.push('_');
            }
        } else {
            out.push_str(&format!("u{:x}", c as u32));
        }
    }
    let out = out.trim_end_matches('_');
    match out.chars().next() {
        Some(c) if c.is_ascii_alphabetic() => out.to_string(),
        _ => format!("v{out}"),
    }
}

/// A name for comments and strings: harmless characters, any other as its code point.
pub(crate) fn plain(name: &str) -> String {
    let piece = |c: char| match c {
        '_' | '(' | ')' | ',' | ' ' | '.' | '-' => c.to_string(),
        c if c.is_alphanumeric() => c.to_string(),
        c => format!("<{:X}>", c as u32),
    };
    name.chars().map(piece).collect()
}

/// Text that cannot end a comment or a string.
pub(crate) fn comment_safe(text: &str) -> String {
    let piece = |c: char| match c {
        '"' | '`' => '\'',
        '\\' => '/',
        // Characters that reverse the direction of text can make code look like a comment.
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => ' ',
        c if c.is_control() => ' ',
        c => c,
    };
    let text: String = text.chars().map(piece).collect();
    text.replace("*/", "* /")
        .replace("/*", "/ *")
        .replace("??", "? ?")
}

/// The name of a system after a space, for comments; empty if it has none.
pub(crate) fn space_and_name(system: Option<&str>) -> String {
    system.map_or_else(String::new, |s| format!(" {}", plain(s)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_words_everywhere() {
        assert_eq!(ascii("lag(y, 1)"), "lag_y_1");
        assert_eq!(ascii("θ"), "u3b8");
        assert_eq!(ascii("1x"), "v1x");
        assert_eq!(ascii(""), "v");
        assert!(ascii(&"long".repeat(100)).len() < 50);
        assert_eq!(plain("lag(θ, 1)"), "lag(θ, 1)");
        assert_eq!(plain("*/ \"x\"\n\\%{"), "<2A><2F> <22>x<22><A><5C><25><7B>");
    }

    #[test]
    fn no_two_names_are_one() {
        let all = ["a b", "a_b", "a(b", "x", "x"];
        let signals = all.iter().enumerate();
        let signals =
            signals.map(|(i, n)| (Signal::shifted(Signal::TIME.var, i as i32), n.to_string()));
        let names = Identifiers::new(signals, ["x"]);
        let given: BTreeSet<&String> = names.by_signal.values().collect();
        assert_eq!(given.len(), all.len());
        assert!(!given.contains(&"x".to_string()));
    }

    #[test]
    fn no_text_ends_a_comment_or_a_string() {
        assert_eq!(comment_safe("a*/b \"c\"\\\n/* ??/"), "a* /b 'c'/ / * ? ?/");
    }
}
