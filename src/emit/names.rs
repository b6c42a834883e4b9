//! Identifiers that are safe in a target language, whatever the model calls its signals.

use std::collections::BTreeMap;

use crate::term::Signal;

/// One ASCII identifier per signal; distinct signals get distinct identifiers.
pub(super) struct Identifiers {
    by_signal: BTreeMap<Signal, String>,
}

impl Identifiers {
    /// `reserved` are words of the target language and names that the emitted code uses itself.
    pub fn new(signals: impl IntoIterator<Item = (Signal, String)>, reserved: &[&str]) -> Self {
        let mut by_signal: BTreeMap<Signal, String> = BTreeMap::new();
        let mut taken: Vec<String> = reserved.iter().map(|r| r.to_string()).collect();
        for (signal, name) in signals {
            let base = ascii(&name);
            let mut candidate = base.clone();
            let mut k = 1;
            while taken.contains(&candidate) {
                k += 1;
                candidate = format!("{base}_{k}");
            }
            taken.push(candidate.clone());
            by_signal.insert(signal, candidate);
        }
        Identifiers { by_signal }
    }

    pub fn get(&self, s: Signal) -> &str {
        self.by_signal.get(&s).map_or("missing", String::as_str)
    }
}

/// Letters, digits and single underscores; other characters become their code point.
fn ascii(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
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
