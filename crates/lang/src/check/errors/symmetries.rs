//! Errors in symmetries, limits and preferences.
//!
//! Constructors only: places and names in, diagnostics out.

use crate::ast::Attribute;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::source::Span;

/// `x, y -> y, x`, `x -> 2*x`
pub fn not_a_flip(at: Span, names: &str) -> Diagnostic {
    Diagnostic::error(
        "symmetry",
        "only changes of sign are understood as symmetries for now",
    )
    .at(at, "not the names with their signs changed")
    .help(format!("write `symmetry {names} -> -({names})`"))
}

pub fn flips_other_names(at: Span, left: Span, names: &str) -> Diagnostic {
    Diagnostic::error("symmetry", "both sides of `->` must list the same names")
        .at(at, "other names here")
        .also(left, "than here")
        .help(format!("write `symmetry {names} -> -({names})`"))
}

pub fn not_a_flipped_name(at: Span) -> Diagnostic {
    Diagnostic::error(
        "symmetry",
        "a symmetry changes the signs of declared variables",
    )
    .at(at, "not one of them")
    .help("list declared variables: `symmetry x, y -> -(x, y)`; or leave the line out")
}

pub fn flipped_derivative(at: Span, derivative: &str, name: &str) -> Diagnostic {
    Diagnostic::error(
        "symmetry",
        format!("`{derivative}` changes its sign with `{name}`"),
    )
    .at(at, "a derivative")
    .help(format!("list `{name}`; derivatives and samples go with it"))
}

pub fn flipped_samples(at: Span) -> Diagnostic {
    Diagnostic::error(
        "symmetry",
        "in a model about samples, time cannot change its sign",
    )
    .at(at, "would make `next` of `lag`")
    .help("leave `t` out")
}

pub fn too_many_symmetries(at: Span, limit: usize) -> Diagnostic {
    Diagnostic::error("too-large", format!("more than {limit} symmetries"))
        .at(at, "one too many")
        .help("join those that always hold together")
}

pub fn too_many_resets(at: Span, limit: usize) -> Diagnostic {
    Diagnostic::error("too-large", format!("more than {limit} lines with `when`"))
        .at(at, "one too many")
        .help("leave out those that never happen in the record")
}

pub fn too_many_constraints(at: Span, limit: usize) -> Diagnostic {
    Diagnostic::error("too-large", format!("more than {limit} constraints"))
        .at(at, "one too many")
        .help("leave out those that follow from others")
}

pub fn unknown_limit(at: Span, key: &str) -> Diagnostic {
    let d = Diagnostic::error("unknown-attribute", format!("no limit named `{key}`"));
    match did_you_mean(key, ["degree"]) {
        Some(near) => d.at(at, format!("did you mean `{near}`?")).fix(at, near),
        None => d.at(at, "not known").fix(at, "degree"),
    }
    .help("write `limit degree 4`")
}

pub fn unknown_norm(key: &Attribute, known: &[&'static str]) -> Diagnostic {
    let (at, text) = (key.key.span, &key.key.text);
    if let (Some(value), true) = (&key.value, known.contains(&text.as_str())) {
        return Diagnostic::error("attribute-value", format!("`prefer {text}` takes no value"))
            .at(value.span, "one too many")
            .help(format!("write `prefer {text}`"))
            .fix(at.to(value.span), text);
    }
    let d = Diagnostic::error("unknown-attribute", format!("no norm named `{text}`"));
    match did_you_mean(text, known.iter().copied()) {
        Some(near) => d.at(at, format!("did you mean `{near}`?")).fix(at, near),
        None => {
            let whole = key.value.as_ref().map_or(at, |v| at.to(v.span));
            let d = d.at(at, "not known");
            known.iter().fold(d, |d, word| d.fix(whole, *word))
        }
    }
    .help("write `prefer degree` or `prefer plain`")
}

pub fn degree_limit(at: Span, value: f64) -> Diagnostic {
    Diagnostic::error(
        "attribute-value",
        format!("a limit on the degree is a number from 0 to 1,000,000, not {value}"),
    )
    .at(at, "not a degree")
    .help("write `limit degree 4`")
    .fix(at, "4")
}
