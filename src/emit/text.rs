//! Equations for people: one line where it fits, one term a line where not; never a fitted term left out.

use super::Target;
use crate::discover::{Discovery, Equation};
use crate::term::{Language, SignalNames};

pub(super) struct Text;

/// Widest line before terms go on lines of their own.
const WIDTH: usize = 100;

impl Target for Text {
    fn name(&self) -> &'static str {
        "text"
    }

    fn about(&self) -> &'static str {
        "equations as the terminal shows them, six significant digits"
    }

    fn emit(&self, d: &Discovery) -> Result<String, String> {
        Ok(equations(d).concat())
    }
}

/// Each equation as its line or lines, targets aligned; every text ends in a newline.
pub fn equations(d: &Discovery) -> Vec<String> {
    let names: Vec<String> = d.equations.iter().map(|e| d.name(e.target)).collect();
    let width = names.iter().map(|n| n.chars().count()).max().unwrap_or(0);
    names
        .iter()
        .zip(&d.equations)
        .map(|(name, e)| {
            let pad = " ".repeat(width - name.chars().count());
            layout(&format!("{name}{pad} = "), &signed_terms(d, e))
        })
        .collect()
}

/// The terms of an equation as `1.5 x - 2 y`, on one line.
pub fn terms_text(d: &Discovery, e: &Equation) -> String {
    signed_terms(d, e)
        .iter()
        .enumerate()
        .map(|(i, t)| first_or_next(i, t))
        .collect::<Vec<_>>()
        .join(" ")
}

fn layout(left: &str, terms: &[(bool, String)]) -> String {
    if terms.is_empty() {
        return format!("{left}0\n");
    }
    let line: Vec<String> = terms
        .iter()
        .enumerate()
        .map(|(i, t)| first_or_next(i, t))
        .collect();
    let line = format!("{left}{}\n", line.join(" "));
    if line.chars().count() <= WIDTH {
        return line;
    }
    let indent = " ".repeat(left.chars().count());
    terms
        .iter()
        .enumerate()
        .map(|(i, (negative, text))| {
            let start = if i == 0 { left } else { &indent };
            let sign = if *negative { '-' } else { '+' };
            format!("{start}{sign} {text}\n")
        })
        .collect()
}

fn first_or_next(i: usize, (negative, text): &(bool, String)) -> String {
    match (i, negative) {
        (0, false) => text.clone(),
        (0, true) => format!("-{text}"),
        (_, false) => format!("+ {text}"),
        (_, true) => format!("- {text}"),
    }
}

/// Sign, and `1.29032 F`; the constant is its number alone.
fn signed_terms(d: &Discovery, e: &Equation) -> Vec<(bool, String)> {
    e.terms
        .iter()
        .map(|t| {
            let size = significant(t.coefficient.abs(), 6);
            let text = if t.term.is_one() {
                size
            } else {
                format!("{size} {}", Language(d).term(&t.term))
            };
            (t.coefficient < 0.0, text)
        })
        .collect()
}

/// A number with so many significant digits, plain or in powers of ten, without trailing zeros.
pub fn significant(x: f64, digits: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let rounded = format!("{x:.*e}", digits - 1);
    let exponent: i32 = rounded
        .split_once('e')
        .and_then(|(_, e)| e.parse().ok())
        .unwrap_or(0);
    if (-4..digits as i32 + 2).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        let plain = format!("{x:.decimals$}");
        if !plain.contains('.') {
            return plain;
        }
        return plain
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_string();
    }
    match rounded.split_once('e') {
        Some((m, e)) if m.contains('.') => {
            format!("{}e{e}", m.trim_end_matches('0').trim_end_matches('.'))
        }
        _ => rounded,
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn numbers_are_short_and_never_zero_by_rounding() {
        let cases = [
            (1.290_322_58, "1.29032"),
            (-0.064_516_129, "-0.0645161"),
            (2.0, "2"),
            (19.6, "19.6"),
            (180_000.0, "180000"),
            (1.5e5, "150000"),
            (5.5e9, "5.5e9"),
            (-4e-4, "-0.0004"),
            (1.234e-9, "1.234e-9"),
            (0.999_999_9, "1"),
        ];
        for (x, text) in cases {
            assert_eq!(significant(x, 6), text);
        }
    }
}
