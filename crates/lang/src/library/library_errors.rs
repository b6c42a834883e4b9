//! Errors and notes about libraries.
//!
//! Constructors only: places and numbers in, a [`Diagnostic`] out.

use crate::diagnostic::Diagnostic;
use crate::library::block_layout::MemoryShare;
use crate::library::generators::generator::Misuse;
use crate::library::readable::{readable, readable_bytes};
use crate::library::sets::term_list::LimitExceeded;
use crate::source::Span;
use crate::thresholds::LIBRARY;

/// Found by arithmetic, before anything is made.
pub(crate) fn too_large(span: Span, terms: u128, bytes: u128, share: MemoryShare) -> Diagnostic {
    let (needed, limit) = (readable_bytes(bytes), readable_bytes(share.bytes.into()));
    let d = Diagnostic::error(
        "library-too-large",
        format!(
            "this library has {} terms, which take {needed}; the limit is {limit}",
            readable(terms)
        ),
    )
    .at(span, format!("{} terms", readable(terms)))
    .help("lower a degree, take atoms out, or say what is known: `limit degree 4`, `symmetry x -> -x`; --memory-limit sets the limit");
    match share.of {
        1 => d,
        of => d.fact(format!("the equations share --memory-limit: 1/{of} each")),
    }
}

/// A set that does not stay a union of products of short lists.
pub(crate) fn limit_exceeded(span: Span, why: LimitExceeded) -> Diagnostic {
    match why {
        LimitExceeded::List(count) => Diagnostic::error(
            "library-too-large",
            format!(
                "{} terms would have to be listed one by one; the limit of one list is {}",
                readable(count),
                readable(LIBRARY.listed_terms)
            ),
        )
        .at(span, "does not stay a product of short lists")
        .help("multiply libraries that have no atom in common, such as poly(x, y; 2) * <1, sin z>, or lower the degree"),
        LimitExceeded::Products => Diagnostic::error(
            "library-too-large",
            format!(
                "this library falls into more than {} products of lists",
                readable(LIBRARY.products as u128)
            ),
        )
        .at(span, "too many unions multiplied")
        .help("lower the degree, or take atoms out"),
    }
}

/// `kept` of `all` terms, if `all` could be counted.
pub(crate) fn pruned(
    span: Span,
    target: &str,
    (kept, all): (u128, Option<u128>),
    by: &str,
) -> Diagnostic {
    let of = all.map_or_else(String::new, |n| format!(" of {}", readable(n)));
    Diagnostic::note(
        "library-pruned",
        format!("{target} has {}{of} candidate terms ({by})", readable(kept)),
    )
    .at(span, "")
}

/// A required term that is not a candidate; `by` are the statements that restrict candidates.
pub(crate) fn required_left_out(span: Span, term: &str, by: Option<String>) -> Diagnostic {
    let d = Diagnostic::error(
        "required-term",
        format!("the required term `{term}` cannot be in this equation"),
    );
    match by {
        Some(by) => d
            .at(span, format!("left out by what the model says: {by}"))
            .help("leave the term out here, or correct the `symmetry` or `limit` line"),
        None => d
            .at(span, "the target itself")
            .help("leave the target out here"),
    }
}

pub(crate) fn too_many_required(span: Span, found: usize, most: usize) -> Diagnostic {
    Diagnostic::error(
        "required-term",
        format!(
            "{} terms are required; the limit is {most}",
            readable(found as u128)
        ),
    )
    .at(span, "beyond the limit with these")
    .help("require the terms that are known to act, and leave the others to the search")
}

/// A term of no definite parity.
pub(crate) fn without_parity(span: Span, symmetry: Span, term: &str, flipped: &str) -> Diagnostic {
    Diagnostic::note(
        "without-parity",
        format!("`{term}` is neither even nor odd in {flipped}: terms like it are left out"),
    )
    .at(span, "")
    .also(
        symmetry,
        "under this symmetry each term has a sign of its own",
    )
}

pub(crate) fn all_pruned(span: Span, target: &str, by: &str) -> Diagnostic {
    Diagnostic::error(
        "empty-library",
        format!("none of these terms may stand in the equation of `{target}` ({by})"),
    )
    .at(span, "nothing left to choose from")
    .help(format!("a term must have the parity of `{target}` under each symmetry, and keep to the limit on the degree; `sidc check --terms` without those statements lists all"))
}

pub(crate) fn misuse(name_span: Span, usage: &str, m: Misuse) -> Diagnostic {
    let d = Diagnostic::error("generator-arguments", m.message);
    let d = match m.at {
        Some(at) => d.at(at, "here"),
        None => d.at(name_span, format!("usage: {usage}")),
    };
    d.help(m.help)
}

/// `removed` is the `-` and its right side; `single` holds both sides as text if each is one term, since a difference of numbers may then
/// be meant.
pub(crate) fn removes_nothing(
    span: Span,
    removed: Span,
    single: Option<(&str, &str)>,
) -> Diagnostic {
    let d = Diagnostic::error(
        "difference-removes-nothing",
        "this `-` removes nothing: none of the terms on its right are on its left",
    )
    .at(
        span,
        "outside `< >`, `A - B` is the set A without the terms of B",
    );
    match single {
        Some((left, right)) => d
            .help(format!(
                "for the number {left} − {right} write `<{left} - {right}>`"
            ))
            .fix(span, format!("<{left} - {right}>")),
        None => d
            .help("leave it out; `sidc check --terms` lists the terms")
            .fix(removed, ""),
    }
}

pub(crate) fn needs_one_term(span: Span, operator: &str, found: u128) -> Diagnostic {
    Diagnostic::error(
        "needs-one-term",
        format!(
            "`{operator}` needs a single term here, but this is a library of {} terms",
            readable(found)
        ),
    )
    .at(span, format!("{} terms", readable(found)))
    .help("divide or raise inside `< >`, term by term: `<x/y, x/z>`")
}

pub(crate) fn number_dropped(span: Span, written: &str, column: &str) -> Diagnostic {
    Diagnostic::note(
        "number-dropped",
        format!("`{written}` is the column `{column}`: its number goes into the coefficient"),
    )
    .at(span, "")
}

pub(crate) fn zero_term(span: Span) -> Diagnostic {
    Diagnostic::error("zero-term", "this term is zero everywhere")
        .at(span, "a column of zeros explains nothing")
        .help("remove it")
}

pub(crate) fn not_finite(span: Span) -> Diagnostic {
    Diagnostic::error(
        "not-finite",
        "this term divides by zero or overflows whatever the data",
    )
    .at(span, "no finite value")
}

pub(crate) fn target_dropped(span: Span, target: &str) -> Diagnostic {
    Diagnostic::note(
        "target-dropped",
        format!("`{target}` is the target here, so it is left out of its own library"),
    )
    .at(span, "")
}

pub(crate) fn empty(span: Span) -> Diagnostic {
    Diagnostic::error("empty-library", "this library has no terms")
        .at(span, "nothing to choose from")
        .help("write at least one candidate, such as `poly(x; 2)`")
}

pub(crate) fn target_by_identity(
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

pub(crate) fn dependent(span: Span, identity: &str, example: &str, count: u128) -> Diagnostic {
    Diagnostic::note(
        "dependent-terms",
        format!(
            "{identity} makes {} of these terms dependent on others",
            readable(count)
        ),
    )
    .at(span, format!("{example}, …"))
    .fact("basis pursuit still finds the sparsest answer; a tie is reported only where it touches the terms found")
}
