//! Errors in declarations and names.
//!
//! Constructors only; the caller decides which name was probably meant.

use crate::ast::{ATTRIBUTES, Call};
use crate::check::vocabulary::GeneratorSignature;
use crate::diagnostic::{Diagnostic, Edit};
use crate::model::Var;
use crate::parse::foreign_spellings::functions::Translation;
use crate::source::Span;

pub fn late_version(at: Span, before: Span) -> Diagnostic {
    Diagnostic::error("version-line", "the version line comes first")
        .at(at, "not the first statement")
        .also(before, "this stands before it")
        .help("move it to the top of the file")
        .edit(Edit::Move(at, before))
}

pub fn future_version(at: Span, version: f64) -> Diagnostic {
    Diagnostic::error(
        "version-line",
        format!("the model asks for version {version} of the language"),
    )
    .at(at, "this program reads version 1")
    .help("write `sidc 1`, or use a newer sidc")
    .fix(at, "sidc 1")
}

/// A second statement or entry where only one is allowed.
pub fn twice(at: Span, first: Span, what: &str) -> Diagnostic {
    Diagnostic::error("given-twice", format!("a second {what}"))
        .at(at, "given again here")
        .also(first, "given first here")
        .help("keep one of the two")
        .remove(at)
}

fn always_taken(at: Span, name: &str) -> Diagnostic {
    let meaning = if name == "t" { "time" } else { "the number π" };
    let message = format!("`{name}` is {meaning} in every model");
    Diagnostic::error("name-taken", message).at(at, "cannot be declared")
}

/// `let t(a) = a`, `let f(t) = t`; the fix renames throughout `within`.
pub fn taken_by_function(at: Span, name: &str, within: Span) -> Diagnostic {
    let other = format!("{name}_0");
    let d = always_taken(at, name).help(format!("choose another name, such as `{other}`"));
    match within == at {
        true => d.edit(Edit::Rename(at, name.to_string())),
        false => d.edit(Edit::RenameAll(within, name.to_string(), other)),
    }
}

pub fn taken(at: Span, name: &str) -> Diagnostic {
    always_taken(at, name).remove(at).help(match name {
        "t" => {
            "use `t` without declaring it; `input t : unit \"h\"` alone says what it is counted in"
        }
        _ => "use `pi` without declaring it, or choose another name",
    })
}

/// `state x` and `input dx`, or one name declared twice; `alone` is true if the place holds one name and not a range.
pub fn clash((at, alone): (Span, bool), var: &Var, derivative: u8, other: &Var) -> Diagnostic {
    let name = "d".repeat(usize::from(derivative)) + &var.name;
    let renamed = match (derivative, other.span) {
        (0, _) | (_, None) => at,
        (_, Some(declared)) => declared,
    };
    let d = if derivative == 0 && other.name == var.name {
        Diagnostic::error("name-clash", format!("`{name}` is declared twice"))
            .at(at, "declared again here")
    } else if derivative == 0 {
        Diagnostic::error(
            "name-clash",
            format!("`{name}` is already a derivative of `{}`", other.name),
        )
        .at(at, format!("declares `{name}` as well"))
    } else {
        Diagnostic::error(
            "name-clash",
            format!(
                "the derivative `{name}` of `{}` is already a name",
                var.name
            ),
        )
        .at(at, format!("makes the name `{name}`"))
    };
    let d = d.also_if_known(other.span, format!("makes the name `{name}` too"));
    let twice = derivative == 0 && other.name == name;
    let d = d.edit(Edit::Rename(renamed, name));
    match twice && alone {
        true => d.help("rename one of the two, or leave it out").remove(at),
        false => d.help("rename one of the two"),
    }
}

pub fn let_clash(at: Span, name: &str, declared: Option<Span>) -> Diagnostic {
    Diagnostic::error("name-clash", format!("`{name}` is already a signal"))
        .at(at, "cannot be defined as well")
        .also_if_known(declared, "declared here")
        .help(format!("choose another name, such as `{name}_0`"))
        .edit(Edit::Rename(at, name.to_string()))
}

pub fn declared_derivative(at: Span, name: &str) -> Diagnostic {
    let base = name.trim_end_matches('\'');
    let order = format!("order {}", name.len() - base.len());
    Diagnostic::error(
        "declared-derivative",
        format!("`{name}` is a derivative and comes with its state"),
    )
    .at(at, "declare the state itself")
    .help(format!("write `state {base} : {order}`"))
    .edit_all([
        Edit::Replace(at, base.to_string()),
        Edit::Attribute(at, "order", order),
    ])
}

/// `gap` is the place between the two words.
pub fn two_names(at: Span, gap: Span, keyword: &str, first: &str, second: &str) -> Diagnostic {
    let d = Diagnostic::error(
        "syntax",
        format!("no comma or colon between `{first}` and `{second}`"),
    )
    .at(at, "two words");
    if ATTRIBUTES.contains(&second) {
        d.help(format!(
            "attributes follow a colon: `{keyword} {first} : {second}`"
        ))
        .fix(gap, " : ")
    } else {
        d.help(format!(
            "names are separated by commas: `{keyword} {first}, {second}`"
        ))
        .fix(gap, ", ")
    }
}

/// `state f(z)`, `state x + y`; `names` are those found in it.
pub fn not_a_name(at: Span, keyword: &str, names: &[&str]) -> Diagnostic {
    let d = Diagnostic::error("syntax", "only a name can be declared").at(at, "not a name");
    let d = match names {
        [] => d.remove(at),
        _ => d.fix(at, names.join(", ")),
    };
    let example = names.first().unwrap_or(&"x");
    match keyword {
        "state" => d.help(format!(
            "write `state {example}`, a range `state x1..x12`, an order as `state {example} : order 2`"
        )),
        _ => d.help(format!(
            "write `{keyword} {example}`, or a range `{keyword} x1..x12`"
        )),
    }
}

pub fn too_many_variables(at: Span, limit: usize) -> Diagnostic {
    Diagnostic::error("too-large", format!("more than {limit} variables"))
        .at(at, "from here on nothing is declared")
        .help("identify parts of the system one at a time")
}

/// `ours` is the replacement in discrete time.
pub fn derivative_in_discrete(at: Span, name: &str, ours: &str, place: Span) -> Diagnostic {
    Diagnostic::error(
        "mixed-time",
        format!("`{name}` is a derivative, and the model is about samples"),
    )
    .at(at, "continuous time")
    .also(place, "discrete time")
    .help(format!(
        "write the whole model with `next`, here with `{ours}`, or the whole model with derivatives"
    ))
    .fix(at, ours)
}

/// `sin` alone; `negated` is the x of `sin -x` and its place, `example` a possible argument.
pub fn function_without_argument(
    at: Span,
    name: &str,
    negated: Option<(&str, Span)>,
    example: &str,
) -> Diagnostic {
    let d = Diagnostic::error(
        "ambiguous-argument",
        format!("the function `{name}` has no argument here"),
    )
    .at(
        at,
        "without parentheses a function takes the one name that follows it",
    );
    match negated {
        Some((x, place)) => d
            .help(format!(
                "write `{name}(-{x})`, or `{name}(…) - {x}` for a difference"
            ))
            .fix(at.to(place), format!("{name}(-{x})")),
        None => d
            .help(format!("write `{name}({example})`"))
            .fix(at, format!("{name}({example})")),
    }
}

/// `example` is a complete call.
pub fn generator_without_arguments(at: Span, name: &str, example: &str) -> Diagnostic {
    Diagnostic::error(
        "generator-form",
        format!("`{name}` generates a library and needs its arguments in parentheses"),
    )
    .at(at, "no plain call")
    .help(format!("write `{example}`"))
    .fix_if_whole(at, example)
}

pub fn let_used_before(at: Span, name: &str, later: Span) -> Diagnostic {
    Diagnostic::error(
        "let-order",
        format!("`{name}` is used before it is defined"),
    )
    .at(at, "not known yet")
    .also(later, "defined here")
    .help(format!("move `let {name}` above this line"))
    .edit(Edit::Move(later, at))
}

pub fn word_elsewhere(at: Span, word: &str, help: &str) -> Diagnostic {
    Diagnostic::error(
        "misplaced-word",
        format!("`{word}` has no meaning in this place"),
    )
    .at(at, "not here")
    .help(help)
}

/// `x(1 - x)` or `x y`, where x is a signal. `fixed` is the text with a `*`; `listed` has a comma instead, if it is two names.
pub fn product_without_sign(
    at: Span,
    name: &str,
    fixed: &str,
    listed: Option<String>,
) -> Diagnostic {
    let d = Diagnostic::error("implicit-product", format!("`{name}` is not a function"))
        .at(at, "a product needs its `*`, a list its comma")
        .fix(at, fixed);
    match listed {
        None => d.help(format!("write `{fixed}`")),
        Some(listed) => d
            .help(format!("write `{fixed}`, or `{listed}` for two"))
            .fix(at, listed),
    }
}

/// Two lines of a list without a comma or operator between them.
pub fn missing_comma(at: Span, left: &str, right: &str) -> Diagnostic {
    Diagnostic::error(
        "implicit-product",
        format!("no comma or operator between `{left}` and `{right}`"),
    )
    .at(at, "the line ends without one")
    .help(format!("for two items of a list write `{left},`"))
    .fix(at.after(), ",")
}

/// A function of other languages; `whole` is the call. `instead` has the same effect where no expression can replace the call.
pub fn foreign_function(
    whole: Span,
    call: &Call,
    meant: Translation,
    instead: Vec<Edit>,
) -> Diagnostic {
    let name = &call.name.text;
    let d = Diagnostic::error(
        "unknown-function",
        format!("no function or generator named `{name}`"),
    );
    match meant {
        Translation::Expression(ours) => d
            .at(whole, format!("write `{ours}`"))
            .help(format!("replace it by `{ours}`"))
            .fix(whole, ours),
        Translation::Advice(advice) => d
            .at(call.name.span, "not known")
            .help(advice)
            .edit_all(instead),
    }
}

pub fn unknown_function(
    at: Span,
    name: &str,
    near: Option<String>,
    generators: &[GeneratorSignature],
) -> Diagnostic {
    let what = if generators.is_empty() {
        "function"
    } else {
        "function or generator"
    };
    let d = Diagnostic::error("unknown-function", format!("no {what} named `{name}`"));
    let d = match near {
        Some(near) => d.at(at, format!("did you mean `{near}`?")).fix(at, near),
        None => d
            .at(at, "not known")
            .help("write it with the functions there are: sec(x) is `1/cos(x)`"),
    };
    let functions: Vec<&str> = crate::term::FUNCTIONS.iter().map(|f| f.name).collect();
    let d = d.fact(format!("functions: {}", functions.join(", ")));
    if generators.is_empty() {
        return d;
    }
    let usages: Vec<&str> = generators.iter().map(|g| g.usage).collect();
    d.fact(format!("generators: {}", usages.join(", ")))
}

pub fn empty_unknown_range(at: Span, from: f64, to: f64) -> Diagnostic {
    Diagnostic::error("empty-range", "the range of an unknown holds no number")
        .at(at, "the second end is to be above the first")
        .help(format!("write `in {}..{}`", to.min(from), from.max(to)))
        .fix(at, format!("{}..{}", to.min(from), from.max(to)))
}

pub fn data_for_unknown(at: Span, name: &str, declared: Option<Span>) -> Diagnostic {
    let d = Diagnostic::error(
        "unknown-in-data",
        format!("{name} is an unknown constant, and the data block says where its values are"),
    )
    .at(at, "what is found is not measured");
    let d = match declared {
        Some(span) => d.also(span, "declared here"),
        None => d,
    };
    d.help(format!(
        "leave the entry out; or write `param {name}` for `unknown {name}` if its values are known"
    ))
    .remove(at)
}
