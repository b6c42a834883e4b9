//! What can be wrong with a library, in words.

use super::size::readable;
use super::{MAX_TERMS, Misuse};
use crate::lang::diagnostic::Diagnostic;
use crate::lang::source::Span;

pub(super) fn too_many_terms(span: Span, count: u128) -> Diagnostic {
    Diagnostic::error(
        "library-too-large",
        format!(
            "this library has {} terms; the limit is {}",
            readable(count),
            readable(MAX_TERMS)
        ),
    )
    .at(span, format!("{} terms", readable(count)))
    .help("lower the degree, or multiply smaller libraries: poly(x, y; 2) * <1, sin z>")
}

pub(super) fn misuse(name_span: Span, usage: &str, m: Misuse) -> Diagnostic {
    let d = Diagnostic::error("generator-arguments", m.message);
    let d = match m.at {
        Some(at) => d.at(at, "here"),
        None => d.at(name_span, format!("usage: {usage}")),
    };
    d.help(m.help)
}

/// `single` holds both sides as text where each is one term, so that a difference of numbers may be meant.
pub(super) fn removes_nothing(span: Span, single: Option<(&str, &str)>) -> Diagnostic {
    let d = Diagnostic::error(
        "difference-removes-nothing",
        "this `-` removes nothing: none of the terms on its right are on its left",
    )
    .at(
        span,
        "outside `< >`, `A - B` is the set A without the terms of B",
    );
    match single {
        Some((left, right)) => d.help(format!(
            "for the number {left} − {right} write `<{left} - {right}>`"
        )),
        None => d.help("leave it out; `sidc check --terms` lists the terms"),
    }
}

pub(super) fn needs_one_term(span: Span, operator: &str, found: usize) -> Diagnostic {
    Diagnostic::error(
        "needs-one-term",
        format!("`{operator}` needs a single term here, but this is a library of {found} terms"),
    )
    .at(span, format!("{found} terms"))
    .help("divide or raise inside `< >`, term by term: `<x/y, x/z>`")
}

pub(super) fn number_dropped(span: Span, written: &str, column: &str) -> Diagnostic {
    Diagnostic::note(
        "number-dropped",
        format!("`{written}` is the column `{column}`: its number goes into the coefficient"),
    )
    .at(span, "")
}

pub(super) fn zero_term(span: Span) -> Diagnostic {
    Diagnostic::error("zero-term", "this term is zero everywhere")
        .at(span, "a column of zeros explains nothing")
        .help("remove it")
}

pub(super) fn not_finite(span: Span) -> Diagnostic {
    Diagnostic::error(
        "not-finite",
        "this term divides by zero or overflows whatever the data",
    )
    .at(span, "no finite value")
}

pub(super) fn target_dropped(span: Span, target: &str) -> Diagnostic {
    Diagnostic::note(
        "target-dropped",
        format!("`{target}` is the target here, so it is left out of its own library"),
    )
    .at(span, "")
}

pub(super) fn empty(span: Span) -> Diagnostic {
    Diagnostic::error("empty-library", "this library has no terms")
        .at(span, "nothing to choose from")
        .help("write at least one candidate, such as `poly(x; 2)`")
}

pub(super) fn target_by_identity(
    span: Span,
    target: &str,
    first: &str,
    second: &str,
) -> Diagnostic {
    Diagnostic::error(
        "target-by-identity",
        format!("this library contains `{target}` itself: {first} + {second} = {target}"),
    )
    .at(
        span,
        format!("`{target}` explains itself by cos^2 + sin^2 = 1"),
    )
    .help(format!("leave out one of the two, `{first}` or `{second}`"))
}

pub(super) fn dependent(span: Span, identity: &str, example: &str, count: usize) -> Diagnostic {
    Diagnostic::note(
        "dependent-terms",
        format!(
            "{identity} makes {} of these terms dependent on others",
            readable(count as u128)
        ),
    )
    .at(span, format!("{example}, …"))
    .fact("basis pursuit still finds the sparsest answer; a tie is reported only where it touches the terms found")
}
