//! LaTeX for terms: \dot, \ddot and Greek letters. It needs amsmath, nothing else.

use crate::typeset::symbols::{GREEK, greek, stem_and_index};
use sidc_lang::number::significant;
use sidc_lang::term::{Func, Notation, Precedence, Signal, SignalNames};
use sidc_system::discovery::Discovery;

/// LaTeX for the signals of one discovery.
pub(crate) struct LatexNotation<'a>(pub &'a Discovery);

impl Notation for LatexNotation<'_> {
    fn signal(&self, s: Signal) -> String {
        let base = name(self.0.variable(s.var));
        match (s.der, s.shift) {
            (0, 0) if self.0.discrete && s != Signal::TIME => format!("{base}[k]"),
            (0, 0) => base,
            (0, k) if k > 0 => format!("{base}[k+{k}]"),
            (0, k) => format!("{base}[k-{}]", -k),
            (1, _) => format!(r"\dot{{{base}}}"),
            (2, _) => format!(r"\ddot{{{base}}}"),
            (3, _) => format!(r"\dddot{{{base}}}"),
            (n, _) => format!("{{{base}}}^{{({n})}}"),
        }
    }

    fn number(&self, x: f64) -> String {
        let text = significant(x, 6);
        match text.split_once('e') {
            Some((m, e)) => format!(r"{m} \cdot 10^{{{e}}}"),
            None => text,
        }
    }

    fn call(&self, f: Func, args: &[String]) -> String {
        match (f.name, args) {
            ("sqrt", [x]) => format!(r"\sqrt{{{x}}}"),
            ("abs", [x]) => format!(r"\left|{x}\right|"),
            _ => format!(r"{}\left({}\right)", f.latex, args.join(", ")),
        }
    }

    fn power(&self, base: &str, exponent: &str) -> (String, Precedence) {
        (format!("{{{base}}}^{{{exponent}}}"), Precedence::Power)
    }

    fn is_constant(&self, s: Signal) -> bool {
        self.0.is_constant(s.var)
    }

    fn product(&self, factors: &[String]) -> String {
        factors.join(r" \, ")
    }

    fn quotient(&self, above: &str, below: &[String]) -> String {
        format!(r"\frac{{{above}}}{{{}}}", self.product(below))
    }

    fn parenthesise(&self, inner: &str) -> String {
        format!(r"\left({inner}\right)")
    }
}

impl LatexNotation<'_> {
    /// Words and figures as upright text in math mode.
    pub fn text(&self, words: &str) -> String {
        let piece = |c: char| match c {
            '_' | '%' | '$' | '&' | '#' | '{' | '}' => format!(r"\{c}"),
            '^' => r"\textasciicircum{}".into(),
            c if c.is_ascii_graphic() && c != '\\' && c != '~' || c == ' ' => c.to_string(),
            c => format!("U+{:X}", c as u32),
        };
        let words: String = words.chars().map(piece).collect();
        format!(r"\text{{{words}}}")
    }
}

/// A variable in math mode: Greek by name or letter; trailing digits, or the part after `_`, as a subscript.
fn name(raw: &str) -> String {
    let (stem, index) = stem_and_index(raw);
    if index.is_empty() {
        word(stem)
    } else {
        format!("{}_{{{}}}", word(stem), word(index))
    }
}

fn word(text: &str) -> String {
    let mut chars = text.chars();
    match (chars.next(), chars.next()) {
        (Some(c), None) => symbol(c),
        _ if greek(text).is_some() => format!(r"\{text}"),
        _ if text.chars().all(|c| c.is_ascii_digit()) => text.to_string(),
        _ => format!(
            r"\mathrm{{{}}}",
            text.chars().map(symbol_in_word).collect::<String>()
        ),
    }
}

fn symbol(c: char) -> String {
    match GREEK.iter().find(|(_, g)| *g == c) {
        Some((n, _)) => format!(r"\{n}"),
        None => symbol_in_word(c),
    }
}

/// Names hold letters, digits and `_`; only characters that TeX takes literally are passed through.
fn symbol_in_word(c: char) -> String {
    match c {
        '_' => r"\_".into(),
        c if c.is_ascii_alphanumeric() => c.to_string(),
        c => match GREEK.iter().find(|(_, g)| *g == c) {
            Some((n, _)) => format!(r"\{n} "),
            None => format!(
                r"\text{{{}}}",
                c.escape_unicode().to_string().replace(['\\', '{', '}'], "")
            ),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::name;

    #[test]
    fn names_become_symbols() {
        assert_eq!(name("theta"), r"\theta");
        assert_eq!(name("θ"), r"\theta");
        assert_eq!(name("x12"), "x_{12}");
        assert_eq!(name("omega_m"), r"\omega_{m}");
        assert_eq!(name("hare"), r"\mathrm{hare}");
        assert_eq!(name("_a_b"), r"\mathrm{\_a\_b}");
    }
}
