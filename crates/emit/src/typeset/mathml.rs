//! MathML Core, which browsers typeset without a script.
//!
//! In: a discovery. Out: `<math>` elements, names escaped. A long equation comes in pieces, one for each term, because
//! MathML does not break lines but the page around it does.

use crate::typeset::symbols::{greek, stem_and_index};
use sidc_lang::number::{significant, with_error};
use sidc_lang::term::{Func, Notation, Precedence, Signal, SignalNames, Term, write_term};
use sidc_system::discovery::{Discovery, Equation, FoundTerm};

/// The notation for one discovery's names.
pub struct MathMl<'a>(pub &'a Discovery);

/// Escapes text for elements and quoted attributes. Control characters, and those that reverse the direction of text,
/// are replaced.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => out.push('\u{fffd}'),
            c if c.is_control() && !matches!(c, '\n' | '\t' | '\r') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Most significant digits of a number.
const DIGITS: usize = 6;

impl MathMl<'_> {
    /// A signal on its own.
    pub fn symbol(&self, s: Signal) -> String {
        format!("<math>{}</math>", self.signal(s))
    }

    /// A term on its own.
    pub fn term(&self, term: &Term) -> String {
        format!("<math>{}</math>", row(&write_term(self, term).0))
    }

    /// The equation in pieces: target and equals sign, then each term with its sign and its coefficient, which has six digits, or fewer
    /// with the standard error in the last two.
    pub fn equation(&self, e: &Equation) -> Vec<String> {
        let left = format!("<math>{}<mo>=</mo></math>", self.signal(e.target));
        let terms = e.terms.iter().enumerate();
        let mut pieces = vec![left];
        pieces.extend(terms.map(|(i, t)| self.piece(i == 0, t)));
        if e.terms.is_empty() {
            pieces.push("<math><mn>0</mn></math>".into());
        }
        pieces
    }

    fn piece(&self, first: bool, t: &FoundTerm) -> String {
        let sign = match (first, t.coefficient < 0.0) {
            (true, false) => "",
            (true, true) => "<mo form=\"prefix\">−</mo>",
            (false, false) => "<mo form=\"infix\">+</mo>",
            (false, true) => "<mo form=\"infix\">−</mo>",
        };
        let error = t.standard_error.unwrap_or(0.0);
        let text = with_error(t.coefficient.abs(), error, DIGITS);
        let size = figures(&text);
        let (term, binds) = write_term(self, &t.term);
        let term = match binds < Precedence::Product {
            true => self.parenthesise(&term),
            false => term,
        };
        let body = match (t.term.is_one(), text == "1") {
            (true, _) => size,
            (false, true) => term,
            (false, false) => format!("{size}<mspace width=\"0.17em\"/>{term}"),
        };
        // After an empty row a sign is infix and gets spaces; as the first element it would be a prefix without them.
        let before = if first { "" } else { "<mrow></mrow>" };
        format!("<math>{before}{sign}{body}</math>")
    }
}

impl Notation for MathMl<'_> {
    fn signal(&self, s: Signal) -> String {
        let base = name(self.0.variable(s.var));
        let base = match s.der {
            0 => base,
            n @ 1..=3 => {
                let dots = ["˙", "¨", "⃛"];
                let dots = dots.get(usize::from(n) - 1).copied().unwrap_or_default();
                dotted(&base, dots)
            }
            n => format!("<msup>{base}{}</msup>", fenced(&format!("<mn>{n}</mn>"))),
        };
        let index = match s.shift {
            0 if self.0.discrete && s != Signal::TIME => "<mi>k</mi>".to_string(),
            0 => return base,
            k if k > 0 => format!("<mi>k</mi><mo>+</mo><mn>{k}</mn>"),
            k => format!("<mi>k</mi><mo>−</mo><mn>{}</mn>", k.unsigned_abs()),
        };
        format!(
            "<mrow>{base}<mo stretchy=\"false\">[</mo>{index}<mo stretchy=\"false\">]</mo></mrow>"
        )
    }

    fn number(&self, x: f64) -> String {
        figures(&significant(x, DIGITS))
    }

    fn call(&self, f: Func, args: &[String]) -> String {
        let inner = args.join("<mo>,</mo>");
        match (f.name, args) {
            ("sqrt", [x]) => format!("<msqrt>{x}</msqrt>"),
            ("abs", [x]) => {
                format!("<mrow><mo form=\"prefix\">|</mo>{x}<mo form=\"postfix\">|</mo></mrow>")
            }
            _ => row(&format!("<mi>{}</mi>{}", escape(f.name), fenced(&inner))),
        }
    }

    fn power(&self, base: &str, exponent: &str) -> (String, Precedence) {
        let text = format!("<msup>{}{}</msup>", row(base), exponent);
        (text, Precedence::Power)
    }

    fn exponent(&self, text: String, _: Precedence) -> String {
        row(&text)
    }

    fn is_constant(&self, s: Signal) -> bool {
        self.0.is_constant(s.var)
    }

    fn product(&self, factors: &[String]) -> String {
        let thin = "<mspace width=\"0.17em\"/>";
        format!("<mrow>{}</mrow>", factors.join(thin))
    }

    fn quotient(&self, above: &str, below: &[String]) -> String {
        format!("<mfrac>{}{}</mfrac>", row(above), self.product(below))
    }

    fn parenthesise(&self, inner: &str) -> String {
        fenced(inner)
    }

    fn sign(&self, first: bool, negative: bool) -> &'static str {
        match (first, negative) {
            (true, false) => "",
            (true, true) => "<mo form=\"prefix\">−</mo>",
            (false, false) => "<mo>+</mo>",
            (false, true) => "<mo>−</mo>",
        }
    }
}

/// A number as it is printed, its exponent raised.
fn figures(text: &str) -> String {
    let text = text.replace('-', "−");
    match text.split_once('e') {
        Some((m, e)) => {
            format!("<mrow><mn>{m}</mn><mo>·</mo><msup><mn>10</mn><mn>{e}</mn></msup></mrow>")
        }
        None => format!("<mn>{text}</mn>"),
    }
}

/// One element, whatever is in it.
fn row(inner: &str) -> String {
    format!("<mrow>{inner}</mrow>")
}

/// In brackets that grow only around fractions, since browsers add space around brackets that can grow.
fn fenced(inner: &str) -> String {
    let stretchy = inner.contains("<mfrac>");
    format!(
        "<mrow><mo form=\"prefix\" stretchy=\"{stretchy}\">(</mo>{inner}<mo form=\"postfix\" stretchy=\"{stretchy}\">)</mo></mrow>"
    )
}

/// Dots go on the stem, not on the index.
fn dotted(base: &str, dots: &str) -> String {
    let over = |stem: &str| format!("<mover accent=\"true\">{stem}<mo>{dots}</mo></mover>");
    let parts = base
        .strip_prefix("<msub>")
        .and_then(|inner| inner.split_once(INDEX));
    match parts {
        Some((stem, rest)) => format!("<msub>{}{INDEX}{rest}", over(stem)),
        None => over(base),
    }
}

/// Opens a subscript.
const INDEX: &str = "<mrow class=\"index\">";

fn name(raw: &str) -> String {
    let (stem, index) = stem_and_index(raw);
    let stem = word(stem);
    match index.is_empty() {
        true => stem,
        false => format!("<msub>{stem}{INDEX}{}</mrow></msub>", word(index)),
    }
}

/// A single letter is italic, a word upright, as in `<mi>`.
fn word(text: &str) -> String {
    match greek(text) {
        Some(letter) => format!("<mi>{letter}</mi>"),
        None if text.chars().all(|c| c.is_ascii_digit()) => format!("<mn>{text}</mn>"),
        None => format!("<mi>{}</mi>", escape(text)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_symbols() {
        assert_eq!(name("theta"), "<mi>θ</mi>");
        assert_eq!(
            name("x12"),
            "<msub><mi>x</mi><mrow class=\"index\"><mn>12</mn></mrow></msub>"
        );
        assert_eq!(name("hare"), "<mi>hare</mi>");
        let dotted = dotted(&name("x_a"), "˙");
        assert!(
            dotted.starts_with("<msub><mover accent=\"true\"><mi>x</mi><mo>˙</mo></mover>"),
            "{dotted}"
        );
    }
}
