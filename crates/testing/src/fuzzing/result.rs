//! Documents that no `identify` wrote: opened, written, opened again, and turned into every language.
//!
//! Promises: a discovery or one refusal; what was opened and written reads back as the same document, word for word; no target panics or
//! writes control characters.

use sidc_emit::{TARGETS, Written};
use sidc_system::discovery::Discovery;
use sidc_system::result;
use sidc_system::result::{Document, DocumentContext, Opened};

/// Most terms of a document that is turned into code.
const FEW: usize = 12;

pub fn result(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let opened = match result::open("fuzz.json", &text) {
        Ok(opened) => opened,
        Err(refusal) => {
            assert!(refusal.is_error() && !refusal.message.is_empty());
            return;
        }
    };
    let once = written(&opened);
    let again =
        result::open("again.json", &once).unwrap_or_else(|d| panic!("{}\n{once}", d.message));
    assert_eq!(written(&again), once, "not a fixed point");
    let d = &opened.discovery;
    if d.equations.iter().map(|e| e.terms.len()).sum::<usize>() <= FEW && d.equations.len() <= 4 {
        emits(d);
    }
}

fn written(opened: &Opened) -> String {
    let text = result::write(&opened.discovery, beside(&opened.document));
    text.expect("a document that was read can be written")
}

fn beside(document: &Document) -> DocumentContext {
    let d = document.clone();
    DocumentContext {
        settings: d.settings,
        signals: d.signals,
        warnings: d.warnings,
        validation: d.validation,
        verdict: d.verdict,
        candidates: d.candidates,
    }
}

fn emits(d: &Discovery) {
    for target in TARGETS {
        match target.emit(d) {
            Ok(Written::Text(text)) => {
                assert!(!text.contains(|c: char| c.is_control() && !"\n\t".contains(c)));
            }
            Ok(Written::Binary { bytes, .. }) => assert!(!bytes.is_empty()),
            Err(why) => assert!(!why.is_empty()),
        }
    }
}
