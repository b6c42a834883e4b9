//! Errors in expressions: arithmetic, libraries, and one where the other is expected.
//!
//! Constructors only; each names the rule that was broken and the spelling that keeps it.

use crate::diagnostic::{Diagnostic, Edit};
use crate::source::Span;
use crate::thresholds::MODEL;

pub fn too_large(at: Span, depth: usize) -> Diagnostic {
    let d = Diagnostic::error(
        "too-large",
        "the expression is too large once every `let` is written out",
    )
    .at(at, "here");
    if depth > MODEL.depth {
        d.fact(format!("nested {depth} deep; the limit is {}", MODEL.depth))
    } else {
        d.fact(format!("more than {} parts", MODEL.statement_nodes))
    }
    .help("use a generator such as `poly(x; 3)` instead of products of products")
}

pub fn model_too_large(at: Span, limit: usize) -> Diagnostic {
    Diagnostic::error(
        "too-large",
        "the model is too large once every `let` and every range is written out",
    )
    .at(at, "up to here")
    .fact(format!("more than {limit} parts"))
    .help("use generators such as `poly(x1..x9; 3)` instead of lists and products of lists")
}

pub fn too_many_factors(at: Span, factors: usize, limit: usize) -> Diagnostic {
    Diagnostic::error("too-large", format!("a product of {factors} factors"))
        .at(at, format!("the limit is {limit}"))
        .help("use powers: `x^12`")
}

pub fn chain_too_long(at: Span, limit: usize, help: &str) -> Diagnostic {
    Diagnostic::error("too-large", format!("more than {limit} parts in one chain"))
        .at(at, "too long")
        .help(help)
}

pub fn share_elsewhere(at: Span, share: f64) -> Diagnostic {
    Diagnostic::error(
        "share-place",
        "a percentage is the noise of a sensor, and has no meaning elsewhere",
    )
    .at(at, "a share of what?")
    .help(format!("write {share:?} for the number"))
    .fix(at, format!("{share:?}"))
}

/// `known`: whether a signal has that name.
pub fn text_in_model(at: Span, text: &str, known: bool) -> Diagnostic {
    let d = Diagnostic::error(
        "quoted-name",
        "a quoted header has no meaning outside the data block",
    )
    .at(at, "a column, not a signal");
    match known {
        true => d.help(format!("write `{text}`")).fix(at, text),
        false => d.help(format!(
            "name it in the data block, `data {{ x = \"{text}\" }}`, and write `x` here"
        )),
    }
}

pub fn library_inside(at: Span, what: &str) -> Diagnostic {
    Diagnostic::error("library-in-expression", format!("{what} cannot be part of an expression"))
        .at(at, "a library, where a number is wanted")
        .help("a library may be a whole item of a list, a whole argument of a generator, or stand on the right of `~`")
        .edit(Edit::Alone(at))
}

pub fn library_by_name_inside(at: Span, name: &str, definition: Span) -> Diagnostic {
    Diagnostic::error(
        "library-in-expression",
        format!("the library `{name}` cannot be part of an expression"),
    )
    .at(at, "a library, where a number is wanted")
    .also(definition, "defined as a library")
    .help(format!(
        "give it an item of its own, `<1, {name}>`, or multiply outside `< >`: `{name} * <x>`"
    ))
    .edit(Edit::Alone(at))
}

pub fn range_inside(at: Span) -> Diagnostic {
    Diagnostic::error(
        "range",
        "a range stands only in a list, among arguments or after `;`",
    )
    .at(at, "no range here")
    .help("write `<x1..x12>`, `poly(x1..x12; 2)` or `poly(x; 1..3)`")
}

/// `x..y`, as two names `x, y`.
pub fn range_of_names(at: Span, listed: &str) -> Diagnostic {
    Diagnostic::error("range", "a range of names needs one stem and two numbers")
        .at(at, "no such range")
        .help(format!("write `{listed}`, or a range such as `x1..x12`"))
        .fix(at, listed)
}

/// `turned` is the range with its ends swapped.
pub fn range_bounds(
    at: Span,
    (from, to): (usize, usize),
    turned: &str,
    limit: usize,
) -> Diagnostic {
    let d = Diagnostic::error(
        "range",
        format!("the range from {from} to {to} cannot be written out"),
    )
    .at(at, "here");
    if from > to {
        d.help(format!("the smaller number comes first: `{turned}`"))
            .fix(at, turned)
    } else {
        d.help(format!("at most {limit} names"))
    }
}

/// `x^y`; `whole` is the power, and `ours` the same with `exp` and `log`.
pub fn exponent_not_a_number(at: Span, whole: Span, ours: &str) -> Diagnostic {
    Diagnostic::error("exponent", "an exponent is a number")
        .at(at, "depends on a signal")
        .help(format!("for a variable exponent write `{ours}`"))
        .fix_if_whole(whole, ours)
}

pub fn not_finite(at: Span) -> Diagnostic {
    Diagnostic::error("not-finite", "this has no finite value")
        .at(at, "infinite, or not a number")
        .help("check its divisors, powers and function arguments, or remove it")
        .remove(at)
}

pub fn division_by_zero(at: Span) -> Diagnostic {
    Diagnostic::error("not-finite", "a division by zero")
        .at(at, "this is 0")
        .help("divide by something else, or remove the term")
        .remove(at)
}

pub fn outside_domain(at: Span, function: &str, domain: &str) -> Diagnostic {
    let d = Diagnostic::error("not-finite", format!("`{function}` has no value here"))
        .at(at, "outside its domain")
        .remove(at);
    match domain {
        "" => d.help("remove the term"),
        _ => d.help(format!("`{function}` takes {domain}; or remove the term")),
    }
}

pub fn not_constant(at: Span, what: &str) -> Diagnostic {
    let example = example_number(what);
    Diagnostic::error(
        "not-constant",
        format!("{what} must be a number known in advance"),
    )
    .at(at, "depends on a signal")
    .help(format!(
        "write a number such as {example}, or a `let` that is one"
    ))
    .fix_if_whole(at, example)
}

/// An example number for this purpose, as in the reference.
fn example_number(what: &str) -> &'static str {
    match what {
        "the number after `;`" => "3",
        "`limit degree`" => "4",
        "`order`" | "an exponent" => "2",
        "`step`" | "`noise`" => "0.01",
        "`memory`" => "0.3",
        "`delay`" => "0.09",
        "the period" => "2*pi",
        _ => "1",
    }
}

pub fn zero_term(at: Span) -> Diagnostic {
    Diagnostic::error("zero-term", "this term is always 0")
        .at(at, "everything cancels")
        .help("remove it from the library")
        .remove(at)
}

/// `sin(x; 2)`; `ours` is the call without a `;`.
pub fn numbers_of_function(at: Span, name: &str, ours: &str) -> Diagnostic {
    Diagnostic::error(
        "arity",
        format!("`{name}` is a function and takes no numbers after a `;`"),
    )
    .at(at, "only generators do")
    .help(format!("separate arguments by commas: `{ours}`"))
    .fix_if_whole(at, ours)
}

/// `ours` is the call with the right number of arguments.
pub fn arity(
    at: Span,
    (name, found): (&str, usize),
    (least, most): (usize, usize),
    ours: &str,
) -> Diagnostic {
    let wanted = match (least, most) {
        (1, 1) => "one argument".to_string(),
        (a, b) => format!("{a} to {b} arguments"),
    };
    Diagnostic::error("arity", format!("`{name}` takes {wanted}, not {found}"))
        .at(at, format!("expected {wanted}"))
        .help(format!("write `{ours}`"))
        .fix_if_whole(at, ours)
}

/// `sin^-1 x`; `whole` is the call.
pub fn inverse_or_reciprocal(at: Span, whole: Span, name: &str, arg: &str) -> Diagnostic {
    let d = Diagnostic::error(
        "ambiguous-argument",
        format!("`{name}^-1` has two readings"),
    )
    .at(at, "inverse, or reciprocal?");
    let (inverse, reciprocal) = (format!("a{name}({arg})"), format!("1/{name}({arg})"));
    match name {
        "sin" | "cos" | "tan" => d
            .help(format!("write `{inverse}` or `{reciprocal}`"))
            .fix_if_whole(whole, inverse),
        _ => d.help(format!("write `{reciprocal}`")),
    }
    .fix_if_whole(whole, reciprocal)
}

/// A built-in word with the wrong number of arguments.
pub fn form(at: Span, word: &str, example: &str) -> Diagnostic {
    Diagnostic::error("arity", format!("`{word}` has another form"))
        .at(at, "not understood")
        .help(format!("write `{example}`"))
        .fix_if_whole(at, example)
}

/// `signal` is what is delayed.
pub fn lag(at: Span, k: f64, signal: &str) -> Diagnostic {
    let near = k.abs().round().clamp(1.0, MODEL.lag);
    Diagnostic::error("lag", format!("a lag of {k} samples does not exist"))
        .at(at, "a whole number from 0 to 1000000")
        .help(if k < 0.0 {
            format!("a lag looks back: write `lag({signal}, {near})`")
        } else {
            format!("write `lag({signal}, {near})`")
        })
        .fix(at, near.to_string())
}

/// `lag(sin(x), 1)`; `ours` is the place of the whole call and its replacement, if there is one.
pub fn shift_of_expression(at: Span, ours: Option<(Span, String)>) -> Diagnostic {
    let d = Diagnostic::error("lag", "only a declared signal can be shifted")
        .at(at, "not the name of one");
    match ours {
        Some((whole, ours)) => d
            .help(format!("shift the names inside: `{ours}`"))
            .fix_if_whole(whole, ours),
        None => d.help("shift the names inside: `sin(lag(x, 1))`"),
    }
}

/// `poly(x, 2)`. `last` is the last argument and whether it is a number; `comma` is the gap before it; `example` is a number with its `;`.
pub fn numbers_missing(
    at: Span,
    name: &str,
    (usage, example): (&str, &str),
    last: Option<(Span, bool)>,
    comma: Option<Span>,
) -> Diagnostic {
    let d = Diagnostic::error(
        "generator-form",
        format!("`{name}` needs a number after a `;`"),
    );
    let d = match last {
        Some((span, true)) => d
            .at(span, "a `;` goes before this, not a comma")
            .also(at, "in this library"),
        _ => d.at(at, "the number is missing"),
    }
    .help(format!("the form is `{usage}`"));
    match (last, comma) {
        (Some((_, true)), Some(comma)) => d.fix(comma, "; "),
        (Some((last, false)), _) => d.fix(last.after(), example),
        _ => d,
    }
}

/// `r - y` between sets; `text` is what was written.
pub fn arithmetic_outside_list(whole: Span, text: &str) -> Diagnostic {
    Diagnostic::error(
        "difference-removes-nothing",
        "outside `< >`, `-` takes terms out of a library, and here it takes out none",
    )
    .at(whole, "sets of terms, not numbers")
    .help(format!("for the number {text} write `<{text}>`"))
    .fix(whole, format!("<{text}>"))
}
