//! How names become symbols, whatever typesets them: Greek letters, and what is an index.

#[rustfmt::skip]
pub(super) const GREEK: &[(&str, char)] = &[
    ("alpha", 'α'), ("beta", 'β'), ("gamma", 'γ'), ("delta", 'δ'), ("epsilon", 'ε'), ("zeta", 'ζ'), ("eta", 'η'),
    ("theta", 'θ'), ("iota", 'ι'), ("kappa", 'κ'), ("lambda", 'λ'), ("mu", 'μ'), ("nu", 'ν'), ("xi", 'ξ'), ("pi", 'π'),
    ("rho", 'ρ'), ("sigma", 'σ'), ("tau", 'τ'), ("upsilon", 'υ'), ("phi", 'φ'), ("chi", 'χ'), ("psi", 'ψ'), ("omega", 'ω'),
    ("Gamma", 'Γ'), ("Delta", 'Δ'), ("Theta", 'Θ'), ("Lambda", 'Λ'), ("Xi", 'Ξ'), ("Pi", 'Π'), ("Sigma", 'Σ'),
    ("Upsilon", 'Υ'), ("Phi", 'Φ'), ("Psi", 'Ψ'), ("Omega", 'Ω'),
];

/// The letter of a name.
pub(super) fn greek(text: &str) -> Option<char> {
    let found = GREEK.iter().find(|(name, _)| *name == text);
    found.map(|(_, letter)| *letter)
}

/// A name's stem and its index: what stands behind the first `_`, or the digits at its end; empty if there are none.
pub(super) fn stem_and_index(raw: &str) -> (&str, &str) {
    match raw.split_once('_') {
        Some((stem, index)) if !stem.is_empty() && !index.is_empty() => (stem, index),
        _ => {
            let stem = raw.trim_end_matches(|c: char| c.is_ascii_digit());
            let stem = if stem.is_empty() { raw } else { stem };
            (stem, raw.strip_prefix(stem).unwrap_or_default())
        }
    }
}
