//! Errors of expressions: arithmetic, libraries, and one in the place of the other.
//!
//! Constructors only; each names the rule that was broken and the spelling that keeps it.

use crate::diagnostic::Diagnostic;
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

pub fn text_in_model(at: Span, text: &str) -> Diagnostic {
    Diagnostic::error(
        "quoted-name",
        "a quoted header has no meaning outside the data block",
    )
    .at(at, "a column, not a signal")
    .help(format!(
        "name it in the data block, `data {{ x = \"{text}\" }}`, and write `x` here"
    ))
}

pub fn library_inside(at: Span, what: &str) -> Diagnostic {
    Diagnostic::error("library-in-expression", format!("{what} cannot be part of an expression"))
        .at(at, "a library, where a number is wanted")
        .help("a library may be a whole item of a list, a whole argument of a generator, or stand on the right of `~`")
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
}

pub fn range_inside(at: Span) -> Diagnostic {
    Diagnostic::error(
        "range",
        "a range stands only in a list, among arguments or after `;`",
    )
    .at(at, "no range here")
    .help("write `<x1..x12>`, `poly(x1..x12; 2)` or `poly(x; 1..3)`")
}

pub fn range_of_names(at: Span) -> Diagnostic {
    Diagnostic::error("range", "a range of names needs one stem and two numbers")
        .at(at, "no such range")
        .help("write `x1..x12`")
}

pub fn range_bounds(at: Span, from: usize, to: usize, limit: usize) -> Diagnostic {
    let d = Diagnostic::error(
        "range",
        format!("the range from {from} to {to} cannot be written out"),
    )
    .at(at, "here");
    if from > to {
        d.help("the smaller number comes first")
    } else {
        d.help(format!("at most {limit} names"))
    }
}

pub fn exponent_not_a_number(at: Span) -> Diagnostic {
    Diagnostic::error("exponent", "an exponent is a number")
        .at(at, "depends on a signal")
        .help("for a variable exponent write `exp(y*log(x))`")
}

pub fn not_finite(at: Span) -> Diagnostic {
    Diagnostic::error("not-finite", "this has no finite value")
        .at(at, "infinite, or not a number")
        .help("check its divisors, powers and function arguments")
}

pub fn division_by_zero(at: Span) -> Diagnostic {
    Diagnostic::error("not-finite", "a division by zero")
        .at(at, "this is 0")
        .help("divide by something else, or remove the term")
}

pub fn outside_domain(at: Span, function: &str, domain: &str) -> Diagnostic {
    let d = Diagnostic::error("not-finite", format!("`{function}` has no value here"))
        .at(at, "outside its domain");
    if domain.is_empty() {
        return d;
    }
    d.help(format!("`{function}` takes {domain}"))
}

pub fn not_constant(at: Span, what: &str) -> Diagnostic {
    Diagnostic::error(
        "not-constant",
        format!("{what} must be a number known in advance"),
    )
    .at(at, "depends on a signal")
    .help("write a number, or a `let` that is one")
}

pub fn zero_term(at: Span) -> Diagnostic {
    Diagnostic::error("zero-term", "this term is always 0")
        .at(at, "everything cancels")
        .help("remove it from the library")
}

pub fn numbers_of_function(at: Span, name: &str) -> Diagnostic {
    Diagnostic::error(
        "arity",
        format!("`{name}` is a function and takes no numbers after a `;`"),
    )
    .at(at, "only generators do")
    .help("separate arguments by commas")
}

pub fn arity(at: Span, name: &str, found: usize, (least, most): (usize, usize)) -> Diagnostic {
    let wanted = match (least, most) {
        (1, 1) => "one argument".to_string(),
        (a, b) => format!("{a} to {b} arguments"),
    };
    Diagnostic::error("arity", format!("`{name}` takes {wanted}, not {found}"))
        .at(at, format!("expected {wanted}"))
        .help(if most == 1 {
            format!("write `{name}(x)`")
        } else {
            format!("write `{name}(x, y)`")
        })
}

pub fn inverse_or_reciprocal(at: Span, name: &str, arg: &str) -> Diagnostic {
    let d = Diagnostic::error(
        "ambiguous-argument",
        format!("`{name}^-1` has two readings"),
    )
    .at(at, "inverse, or reciprocal?");
    match name {
        "sin" | "cos" | "tan" => d.help(format!("write `a{name}({arg})` or `1/{name}({arg})`")),
        _ => d.help(format!("write `1/{name}({arg})`")),
    }
}

/// A built-in word with the wrong number of arguments.
pub fn form(at: Span, word: &str, example: &str) -> Diagnostic {
    Diagnostic::error("arity", format!("`{word}` has another form"))
        .at(at, "not understood")
        .help(format!("write `{example}`"))
}

pub fn lag(at: Span, k: f64) -> Diagnostic {
    Diagnostic::error("lag", format!("a lag of {k} samples does not exist"))
        .at(at, "a whole number from 0 to 1000000")
        .help(if k < 0.0 {
            "a lag looks back: `lag(u, 2)` is two samples ago"
        } else {
            "write `lag(u, 2)`"
        })
}

pub fn shift_of_expression(at: Span) -> Diagnostic {
    Diagnostic::error("lag", "only a declared signal can be shifted")
        .at(at, "not the name of one")
        .help("shift the names inside: `sin(lag(x, 1))`")
}

/// `poly(x, 2)`: `last` is the last argument, and whether it is a number; `comma` what stands before that.
pub fn numbers_missing(
    at: Span,
    name: &str,
    usage: &str,
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
