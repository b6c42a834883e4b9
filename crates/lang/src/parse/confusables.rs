//! Characters pasted from papers and word processors that look like ASCII ones (Unicode UTS #39 calls them confusables).
//!
//! In: one character or name. Out: its ASCII spelling, if it has one. Never changes a text.

use unicode_normalization::UnicodeNormalization;

/// The spelling of a pasted sign in the language.
pub fn ascii(c: char) -> Option<&'static str> {
    Some(match c {
        '·' | '×' | '⋅' | '∙' | '•' | '∗' => "*",
        '−' | '–' | '—' | '‐' | '‑' => "-",
        '÷' | '∕' | '⁄' => "/",
        '’' | '‘' | '′' | '´' | '`' => "'",
        '″' => "''",
        '“' | '”' | '„' | '«' | '»' => "\"",
        '≤' => "<=",
        '≥' => ">=",
        '∼' | '≈' | '～' | '∝' => "~",
        '⟨' | '〈' | '‹' => "<",
        '⟩' | '〉' | '›' => ">",
        '…' => "..",
        '[' => "<",
        ']' => ">",
        _ => return superscript(c).or_else(|| subscript(c)),
    })
}

/// The spelling of a run of pasted signs: `²` is `^2`, `¹²` is `^12`.
pub fn ascii_run(run: &str) -> String {
    let mut out = String::new();
    let mut raised = false;
    for c in run.chars() {
        let up = superscript(c).is_some();
        if up && !raised {
            out.push('^');
        }
        raised = up;
        out.push_str(ascii(c).unwrap_or(""));
    }
    out
}

fn superscript(c: char) -> Option<&'static str> {
    Some(match c {
        '⁰' => "0",
        '¹' => "1",
        '²' => "2",
        '³' => "3",
        '⁴' => "4",
        '⁵' => "5",
        '⁶' => "6",
        '⁷' => "7",
        '⁸' => "8",
        '⁹' => "9",
        '⁻' => "-",
        _ => return None,
    })
}

fn subscript(c: char) -> Option<&'static str> {
    Some(match c {
        '₀' => "0",
        '₁' => "1",
        '₂' => "2",
        '₃' => "3",
        '₄' => "4",
        '₅' => "5",
        '₆' => "6",
        '₇' => "7",
        '₈' => "8",
        '₉' => "9",
        _ => return None,
    })
}

/// The spelling of a name with combining marks that no precomposed letter has: dots become leading `d`s, other marks are dropped.
pub fn accented(name: &str) -> Option<String> {
    if !name.contains(is_mark) {
        return None;
    }
    Some(undotted(name))
}

/// Newton's dots as derivatives: `ẋ` is `dx`, `θ̈` is `ddθ`.
pub fn dotted(name: &str) -> Option<String> {
    let decomposed: String = name.nfd().collect();
    decomposed
        .contains(['\u{307}', '\u{308}', '\u{20DB}'])
        .then(|| undotted(name))
}

/// How other languages spell derivatives: `d2x`, `x_dot`, `xddot`.
pub fn spelt_elsewhere(name: &str) -> Option<String> {
    if let Some(numbered) = name.strip_prefix('d')
        && let Some(order) = numbered.chars().next().and_then(|c| c.to_digit(10))
    {
        let rest = numbered.get(1..).filter(|rest| !rest.is_empty())?;
        return Some("d".repeat(order as usize) + rest);
    }
    let base = name.strip_suffix("dot")?;
    let letters = base.trim_end_matches('d');
    let order = 1 + base.len() - letters.len();
    let letters = letters.trim_end_matches('_');
    (!letters.is_empty()).then(|| "d".repeat(order) + letters)
}

fn undotted(name: &str) -> String {
    let mut order = 0;
    let mut letters = String::new();
    for c in name.nfd() {
        match c {
            '\u{307}' => order += 1,
            '\u{308}' => order += 2,
            '\u{20DB}' => order += 3,
            c if is_mark(c) => {}
            c => letters.push(c),
        }
    }
    "d".repeat(order) + &letters
}

fn is_mark(c: char) -> bool {
    matches!(c, '\u{300}'..='\u{36F}' | '\u{20D0}'..='\u{20F0}')
}

const GREEK: &[(char, &str)] = &[
    ('α', "alpha"),
    ('β', "beta"),
    ('γ', "gamma"),
    ('δ', "delta"),
    ('ε', "epsilon"),
    ('ζ', "zeta"),
    ('η', "eta"),
    ('θ', "theta"),
    ('κ', "kappa"),
    ('λ', "lambda"),
    ('μ', "mu"),
    ('µ', "mu"),
    ('ν', "nu"),
    ('ξ', "xi"),
    ('ρ', "rho"),
    ('σ', "sigma"),
    ('τ', "tau"),
    ('φ', "phi"),
    ('ϕ', "phi"),
    ('χ', "chi"),
    ('ψ', "psi"),
    ('ω', "omega"),
    ('Δ', "Delta"),
    ('Θ', "Theta"),
    ('Φ', "Phi"),
    ('Ψ', "Psi"),
    ('Ω', "Omega"),
];

/// A name with its Greek letters written out, so that `θ` and `theta` compare equal.
pub fn spelt_out(name: &str) -> String {
    name.chars().fold(String::new(), |mut out, c| {
        match GREEK.iter().find(|(g, _)| *g == c) {
            Some((_, word)) => out.push_str(word),
            None => out.push(c),
        }
        out
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_of_papers_have_spellings() {
        for (signs, spelling) in [
            ("·×⋅∙•∗", "*"),
            ("−–—‐‑", "-"),
            ("÷∕⁄", "/"),
            ("’‘′´`", "'"),
            ("″", "''"),
            ("“”„«»", "\""),
            ("≤", "<="),
            ("≥", ">="),
            ("∼≈～∝", "~"),
            ("⟨〈‹[", "<"),
            ("⟩〉›]", ">"),
            ("…", ".."),
        ] {
            for sign in signs.chars() {
                assert_eq!(ascii(sign), Some(spelling), "{sign}");
            }
        }
        assert_eq!("aθ(+".chars().find_map(ascii), None);
    }

    #[test]
    fn raised_and_lowered_digits_are_digits() {
        assert_eq!(ascii_run("⁰¹²³⁴⁵⁶⁷⁸⁹"), "^0123456789");
        assert_eq!(ascii_run("⁻¹"), "^-1");
        assert_eq!(ascii_run("₀₁₂₃₄₅₆₇₈₉"), "0123456789");
        assert_eq!(ascii_run("²₁²"), "^21^2");
    }
}
