//! Names as mathematical symbols: Greek letters and subscripts.

#[rustfmt::skip]
pub(crate) const GREEK: &[(&str, char)] = &[
    ("alpha", 'α'), ("beta", 'β'), ("gamma", 'γ'), ("delta", 'δ'), ("epsilon", 'ε'), ("zeta", 'ζ'), ("eta", 'η'),
    ("theta", 'θ'), ("iota", 'ι'), ("kappa", 'κ'), ("lambda", 'λ'), ("mu", 'μ'), ("nu", 'ν'), ("xi", 'ξ'), ("pi", 'π'),
    ("rho", 'ρ'), ("sigma", 'σ'), ("tau", 'τ'), ("upsilon", 'υ'), ("phi", 'φ'), ("chi", 'χ'), ("psi", 'ψ'), ("omega", 'ω'),
    ("Gamma", 'Γ'), ("Delta", 'Δ'), ("Theta", 'Θ'), ("Lambda", 'Λ'), ("Xi", 'Ξ'), ("Pi", 'Π'), ("Sigma", 'Σ'),
    ("Upsilon", 'Υ'), ("Phi", 'Φ'), ("Psi", 'Ψ'), ("Omega", 'Ω'),
];

/// The Greek letter of that name.
pub(crate) fn greek(text: &str) -> Option<char> {
    let found = GREEK.iter().find(|(name, _)| *name == text);
    found.map(|(_, letter)| *letter)
}

/// Stem and index of a name: the index is the part after the first `_`, or trailing digits; it may be empty.
pub(crate) fn stem_and_index(raw: &str) -> (&str, &str) {
    match raw.split_once('_') {
        Some((stem, index)) if !stem.is_empty() && !index.is_empty() => (stem, index),
        _ => {
            let stem = raw.trim_end_matches(|c: char| c.is_ascii_digit());
            let stem = if stem.is_empty() { raw } else { stem };
            (stem, raw.strip_prefix(stem).unwrap_or_default())
        }
    }
}
