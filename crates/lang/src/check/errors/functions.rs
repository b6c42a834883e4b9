//! Errors in functions that a model defines.

use crate::ast::Ident;
use crate::diagnostic::{Diagnostic, Edit};
use crate::source::Span;

/// A call with the wrong number of arguments; `ours` is the call with the right number.
pub fn own_arity(
    (at, definition): (Span, Span),
    name: &str,
    params: &[Ident],
    found: usize,
    ours: &str,
) -> Diagnostic {
    let wanted = match params.len() {
        1 => "one argument".to_string(),
        n => format!("{n} arguments"),
    };
    let names: Vec<&str> = params.iter().map(|p| p.text.as_str()).collect();
    Diagnostic::error("arity", format!("`{name}` takes {wanted}, not {found}"))
        .at(at, format!("expected {wanted}"))
        .also(definition, "defined here")
        .help(format!(
            "write `{name}({})` with an expression for each, such as `{ours}`",
            names.join(", ")
        ))
        .fix_if_whole(at, ours)
}

/// `let f(a, a) = …`
pub fn second_argument(at: Span, first: Span, name: &str) -> Diagnostic {
    Diagnostic::error("given-twice", format!("a second argument `{name}`"))
        .at(at, "given again here")
        .also(first, "given first here")
        .help(format!("choose another name, such as `{name}_0`"))
        .edit(Edit::Rename(at, name.to_string()))
}

/// An argument whose name means something else in the model; `renamed` is the statement with the argument renamed.
pub fn argument_hides(
    (at, declared): (Span, Option<Span>),
    (name, meaning): (&str, &str),
    other: &str,
    statement: Span,
    renamed: String,
) -> Diagnostic {
    Diagnostic::error(
        "name-clash",
        format!("the argument `{name}` has the name of {meaning}"),
    )
    .at(at, "which of the two is meant in the function?")
    .also_if_known(declared, "declared here")
    .help(format!("give the argument another name: `{other}`"))
    .fix(statement, renamed)
}

/// `a'` of an argument a; `last` is the place after the last argument.
pub fn argument_differentiated(at: Span, name: &str, last: Option<Span>) -> Diagnostic {
    let rate = format!("d{name}");
    let d = Diagnostic::error("unknown-signal", format!("the argument `{name}` has no derivative"))
        .at(at, "an argument is a number")
        .help(format!(
            "give the derivative as an argument of its own: `let f({name}, {rate}) = …`, called as `f(x, dx)`"
        ));
    match last {
        Some(last) => d.edit_all([
            Edit::Replace(last, format!(", {rate}")),
            Edit::Replace(at, rate),
        ]),
        None => d,
    }
}

pub fn form_as_function(at: Span, name: &str) -> Diagnostic {
    Diagnostic::error(
        "name-taken",
        format!("`{name}(…)` has a meaning in every model"),
    )
    .at(at, "cannot be defined")
    .help(format!("choose another name, such as `{name}_0`"))
    .edit(Edit::Rename(at, name.to_string()))
}

/// A function that replaces a built-in one.
pub fn function_replaced(at: Span, name: &str) -> Diagnostic {
    Diagnostic::note(
        "function-replaced",
        format!("`{name}` is this model's own function, not that of the language"),
    )
    .at(at, "holds wherever the model calls it")
}

/// `f(x) = x^2`
pub fn function_without_let(at: Span, statement: Span, line: &str) -> Diagnostic {
    Diagnostic::error("target", "a function is defined by `let`")
        .at(at, "no target of an equation")
        .help(format!("write `let {line}`"))
        .fix(statement.before(), "let ")
}

/// A call in the data block; `at` is the place of its name, `ours` the function's body with the columns.
pub fn own_function_in_data((at, whole): (Span, Span), ours: &str, definition: Span) -> Diagnostic {
    Diagnostic::error(
        "unknown-function",
        "functions of the model take signals, not columns",
    )
    .at(at, "not in a data block")
    .also(definition, "defined here")
    .help(format!(
        "write it out with the column in quotes in place of the argument: `{ours}`"
    ))
    .fix_if_whole(whole, ours)
}

/// `let f(v) = 1 + f(v - 1)`, `let a = a + x`
pub fn recursive(at: Span, name: &str, definition: Span) -> Diagnostic {
    Diagnostic::error("let-order", format!("`{name}` is defined by itself"))
        .at(at, "its own name")
        .also(definition, "in this definition")
        .help("a definition is an expression of what stands above it; write out what is meant, or remove the term")
        .remove(at)
}
