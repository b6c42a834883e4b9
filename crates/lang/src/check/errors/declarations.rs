//! Errors of declarations, attributes and names.
//!
//! Constructors only; the caller decides which name was probably meant.

use crate::ast::{ATTRIBUTES, Call};
use crate::check::vocabulary::GeneratorSignature;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::model::Var;
use crate::parse::foreign_spellings::functions::Meant;
use crate::source::Span;

pub fn late_version(at: Span, before: Span) -> Diagnostic {
    Diagnostic::error("version-line", "the version line comes first")
        .at(at, "not the first statement")
        .also(before, "this stands before it")
        .help("move it to the top of the file")
}

pub fn future_version(at: Span, version: f64) -> Diagnostic {
    Diagnostic::error(
        "version-line",
        format!("the model asks for version {version} of the language"),
    )
    .at(at, "this program reads version 1")
    .help("write `sidc 1`, or use a newer sidc")
}

/// A second statement or entry of a kind that is given once.
pub fn twice(at: Span, first: Span, what: &str) -> Diagnostic {
    Diagnostic::error("given-twice", format!("a second {what}"))
        .at(at, "given again here")
        .also(first, "given first here")
        .help("keep one of the two")
}

pub fn taken(at: Span, name: &str) -> Diagnostic {
    let meaning = if name == "t" { "time" } else { "the number π" };
    Diagnostic::error(
        "name-taken",
        format!("`{name}` is {meaning} in every model"),
    )
    .at(at, "cannot be declared")
    .help(match name {
        "t" => {
            "use `t` without declaring it; `input t : unit \"h\"` alone says what it is counted in"
        }
        _ => "use `pi` without declaring it, or choose another name",
    })
}

/// `state x` and `input dx`, or one name declared twice.
pub fn clash(at: Span, var: &Var, derivative: u8, other: &Var) -> Diagnostic {
    let name = "d".repeat(usize::from(derivative)) + &var.name;
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
    d.also_if_known(other.span, format!("makes the name `{name}` too"))
        .help("rename one of the two")
}

pub fn let_clash(at: Span, name: &str, declared: Option<Span>) -> Diagnostic {
    Diagnostic::error("name-clash", format!("`{name}` is already a signal"))
        .at(at, "cannot be defined as well")
        .also_if_known(declared, "declared here")
        .help(format!("choose another name, such as `{name}_0`"))
}

pub fn declared_derivative(at: Span, name: &str) -> Diagnostic {
    let base = name.trim_end_matches('\'');
    let order = name.len() - base.len();
    Diagnostic::error(
        "declared-derivative",
        format!("`{name}` is a derivative and comes with its state"),
    )
    .at(at, "declare the state itself")
    .help(format!("write `state {base} : order {order}`"))
}

/// `gap`: between the two words.
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

pub fn not_a_name(at: Span, keyword: &str, example: &str) -> Diagnostic {
    let d = Diagnostic::error("syntax", "only a name can be declared").at(at, "not a name");
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

pub fn unknown_attribute(at: Span, key: &str, known: &[&str]) -> Diagnostic {
    let d = Diagnostic::error("unknown-attribute", format!("no attribute named `{key}`"));
    let d = match did_you_mean(key, known.iter().copied()) {
        Some(near) => d.at(at, format!("did you mean `{near}`?")).fix(at, near),
        None => d.at(at, "not known"),
    };
    d.fact("attributes: order 2, noise 0.01 or 2%, unit \"m\"; for inputs hold or linear; for inputs and states delay 0.09; for states memory 0.3 or hidden")
}

pub fn attribute_elsewhere(at: Span, key: &str, keyword: &str) -> Diagnostic {
    let d = Diagnostic::error(
        "attribute-place",
        format!("`{key}` says nothing about {}", plural(keyword)),
    )
    .at(at, "has no meaning here");
    match key {
        "hold" | "linear" => d.help("it is for inputs: how they move between samples"),
        "order" => d.help("it is for states and inputs: how many derivatives exist"),
        "hidden" => d.help("it is for states: nothing measures it"),
        "delay" => {
            d.help("it is for inputs, which act late, and for states, whose sensor reads late")
        }
        _ => d.help("remove it"),
    }
}

fn plural(keyword: &str) -> &'static str {
    match keyword {
        "state" => "a state",
        "input" => "an input",
        "output" => "an output",
        _ => "a parameter",
    }
}

pub fn order(at: Span, value: f64, least: u8, most: u8) -> Diagnostic {
    Diagnostic::error(
        "attribute-value",
        format!("the order {value} does not exist"),
    )
    .at(at, format!("a whole number from {least} to {most}"))
    .help("write `order 2` for a name with two derivatives")
}

pub fn noise(at: Span, value: &str) -> Diagnostic {
    Diagnostic::error(
        "attribute-value",
        format!("a noise of {value} is not a standard deviation"),
    )
    .at(
        at,
        "a number above 0 in the unit of the signal, a share of the value, or both",
    )
    .help("leave `noise` out if it is not known")
}

/// `memory -0.3`
pub fn negative_memory(at: Span, seconds: f64) -> Diagnostic {
    Diagnostic::error(
        "attribute-value",
        format!("a memory of {seconds} s is no time"),
    )
    .at(at, "a number that is not negative")
    .help("leave `memory` out if it is not known; `memory 0` says that the noise is white")
}

pub fn memory_in_discrete(at: Span, place: Span) -> Diagnostic {
    Diagnostic::error(
        "mixed-time",
        "a model about samples knows no memory of noise in seconds",
    )
    .at(at, "has no meaning here")
    .also(place, "makes it a model about samples")
    .help("remove it")
}

/// `delay -0.1`
pub fn negative_delay(at: Span, seconds: f64) -> Diagnostic {
    Diagnostic::error(
        "attribute-value",
        format!("a delay of {seconds} s is an advance"),
    )
    .at(at, "a number that is not negative")
    .help(format!(
        "if the record may be late, let it be sought: `delay in {seconds} .. {}`",
        -seconds
    ))
    .fix(at, format!("in {seconds}..{}", -seconds))
}

/// `delay in 0.2 .. 0.1`
pub fn empty_delay_range(at: Span, from: f64, to: f64) -> Diagnostic {
    let d = Diagnostic::error("attribute-value", "a range of delays ends above its start");
    let d = d.at(at, format!("{from} is not below {to}"));
    match from > to {
        true => d
            .help(format!("write `delay in {to} .. {from}`"))
            .fix(at, format!("{to}..{from}")),
        false => d.help(format!("for a delay that is known write `delay {from}`")),
    }
}

pub fn delay_in_discrete(at: Span, place: Span, keyword: &str) -> Diagnostic {
    let d = Diagnostic::error(
        "mixed-time",
        "a model about samples has no delays in seconds",
    )
    .at(at, "has no meaning here")
    .also(place, "makes it a model about samples");
    match keyword {
        "input" => d.help(
            "remove it, and write the delay in the equations: `lag(u, 2)` is u two samples before",
        ),
        _ => d.help("remove it, and shift the column in the table by whole samples"),
    }
}

pub fn attribute_value(at: Span, key: &str, wanted: &str, example: &str) -> Diagnostic {
    Diagnostic::error("attribute-value", format!("`{key}` takes {wanted}"))
        .at(at, format!("{wanted} is missing"))
        .help(format!("write `{example}`"))
}

pub fn attribute_without_value(at: Span, key: &str) -> Diagnostic {
    Diagnostic::error("attribute-value", format!("`{key}` takes no value"))
        .at(at, "remove this")
        .help(format!("write `{key}`"))
        .fix(at, "")
}

pub fn hold_and_linear(at: Span) -> Diagnostic {
    Diagnostic::error(
        "attribute-value",
        "an input either holds its value or moves linearly between samples",
    )
    .at(at, "contradicts the attribute before")
    .help("keep one of `hold` and `linear`")
}

pub fn order_in_discrete(at: Span, place: Span) -> Diagnostic {
    Diagnostic::error("mixed-time", "a model about samples has no derivatives")
        .at(at, "declares derivatives")
        .also(place, "makes the model discrete")
        .help("remove `order`; earlier samples are `lag(x, 1)`")
}

pub fn derivative_in_discrete(at: Span, name: &str, place: Span) -> Diagnostic {
    Diagnostic::error(
        "mixed-time",
        format!("`{name}` is a derivative, and the model is about samples"),
    )
    .at(at, "continuous time")
    .also(place, "discrete time")
    .help("write the whole model with `next`, or the whole model with derivatives")
}

/// `sin` alone; `negated` is the x of `sin -x`.
pub fn function_without_argument(at: Span, name: &str, negated: Option<&str>) -> Diagnostic {
    let d = Diagnostic::error(
        "ambiguous-argument",
        format!("the function `{name}` has no argument here"),
    )
    .at(
        at,
        "without parentheses a function takes the one name that follows it",
    );
    match negated {
        Some(x) => d.help(format!(
            "write `{name}(-{x})`, or `{name}(…) - {x}` for a difference"
        )),
        None => d.help(format!("write `{name}(x)`")),
    }
}

pub fn generator_without_arguments(at: Span, name: &str, usage: &str) -> Diagnostic {
    Diagnostic::error(
        "generator-form",
        format!("`{name}` generates a library and needs its arguments in parentheses"),
    )
    .at(at, "no plain call")
    .help(format!("write `{usage}`"))
}

pub fn let_used_before(at: Span, name: &str, later: Span) -> Diagnostic {
    Diagnostic::error(
        "let-order",
        format!("`{name}` is used before it is defined"),
    )
    .at(at, "not known yet")
    .also(later, "defined here")
    .help(format!("move `let {name}` above this line"))
}

pub fn word_elsewhere(at: Span, word: &str, help: &str) -> Diagnostic {
    Diagnostic::error(
        "misplaced-word",
        format!("`{word}` has no meaning in this place"),
    )
    .at(at, "not here")
    .help(help)
}

/// `x(1 - x)`, `x y` where x is a signal; `fixed` is the same with its `*`, `listed` with a comma where two names stand side by side.
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

/// Two lines of a list, and nothing between them.
pub fn missing_comma(at: Span, left: &str, right: &str) -> Diagnostic {
    Diagnostic::error(
        "implicit-product",
        format!("no comma or operator between `{left}` and `{right}`"),
    )
    .at(at, "the line ends without one")
    .help(format!("for two items of a list write `{left},`"))
    .fix(at.after(), ",")
}

/// A function that other languages have; `whole` is the call.
pub fn foreign_function(whole: Span, call: &Call, meant: Meant) -> Diagnostic {
    let name = &call.name.text;
    let d = Diagnostic::error(
        "unknown-function",
        format!("no function or generator named `{name}`"),
    );
    match meant {
        Meant::Expression(ours) => d
            .at(whole, format!("write `{ours}`"))
            .help(format!("replace it by `{ours}`"))
            .fix(whole, ours),
        Meant::Advice(advice) => d.at(call.name.span, "not known").help(advice),
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

pub fn unknown_attribute_of_unknown(at: Span, key: &str) -> Diagnostic {
    Diagnostic::error(
        "unknown-attribute",
        format!("an unknown constant has no attribute `{key}`"),
    )
    .at(at, "not `unit` and not `per run`")
    .help("the forms are `unknown k in 0.1..10, unit \"1/s\"` and `unknown L : per run`")
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
}
