//! Texts that nobody meant as a model: parsed, checked, shown and formatted.
//!
//! Promises: never a panic; errors if and only if there is no model; formatting that changes only white space, and nothing when repeated;
//! time linear in the length.

use std::sync::OnceLock;

use super::clock::Pace;
use sidc::pipeline::vocabulary;
use sidc_lang as lang;
use sidc_lang::source::{FileId, Sources};
use sidc_lang::{parse, render};

const KNOWN: &str = "sidc 1\nsystem s\nstate x, y : order 2, noise 0.1\ninput u : hold\nparam m\nlet g = 9.8\nlet trig = <1, sin x, cos x>\ndata {\n  t = \"T\" * 1e-3\n  x = unwrap(\"A\", 2*pi)\n}\nddx ~ known(-g/m * sin x) + poly(x, dx, u; 1..2) * trig - <x>\nddy = u^2 - y/m\nconstrain 0 < coef(ddx, u) < 2*coef(ddx, dx) + 1\n";

/// Texts are repeated up to this many bytes to see how time grows.
const LONG: usize = 32 * 1024;

pub fn language(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    pace().keep(text.len(), more(&text), || survives(&text));
    // A test of growth costs as much as a thousand short inputs, so that only some inputs get it, and always the same.
    if !text.is_empty()
        && data
            .iter()
            .map(|b| usize::from(*b))
            .sum::<usize>()
            .is_multiple_of(64)
    {
        let long = text.repeat(LONG / text.len().min(LONG));
        pace().keep(long.len(), more(&long), || survives(&long));
    }
}

/// What a short name can stand for is bounded by a constant, not by the length of the text: two million parts, ten thousand variables.
fn more(text: &str) -> u32 {
    if text.contains("let") || text.contains("..") {
        60
    } else {
        0
    }
}

fn pace() -> Pace {
    static PACE: OnceLock<Pace> = OnceLock::new();
    *PACE.get_or_init(|| Pace::of(KNOWN.len(), || survives(KNOWN)))
}

fn survives(text: &str) {
    let mut sources = Sources::default();
    let file = sources.add("fuzz.sid", text);
    let (model, found) = lang::compile(file, &sources, &vocabulary());
    assert_eq!(model.is_none(), found.iter().any(|d| d.is_error()));
    let shown = render(&found, &sources, false);
    assert_eq!(shown.is_empty(), found.is_empty());
    assert!(!shown.contains(|c: char| c.is_control() && !"\n\t".contains(c)));
    let errors = parse(FileId(0), text).1;
    match lang::format(FileId(0), text) {
        Ok(once) => {
            assert!(errors.is_empty());
            assert_eq!(ink(&once), ink(text), "something was lost or added");
            let twice = lang::format(FileId(0), &once).expect("a layout is a text without errors");
            assert_eq!(twice, once, "not a fixed point");
            if text.len() <= 4096 {
                assert_eq!(shape(&once), shape(text), "the meaning changed");
            }
        }
        Err(_) => assert!(!errors.is_empty()),
    }
}

/// All characters but white space, including those of comments.
fn ink(text: &str) -> String {
    let blank = |c: &char| c.is_whitespace() || *c == '\u{feff}';
    text.chars().filter(|c| !blank(c)).collect()
}

/// The syntax tree without positions in the source.
fn shape(text: &str) -> String {
    let shown = format!("{:?}", parse(FileId(0), text).0.statements);
    let mut out = String::new();
    let mut rest = shown.as_str();
    while let Some(at) = rest.find("Span {") {
        out.push_str(&rest[..at]);
        let end = rest[at..].find('}').map_or(rest.len(), |end| at + end + 1);
        rest = &rest[end..];
    }
    out + rest
}
