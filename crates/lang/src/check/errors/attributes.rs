//! Errors in attributes: wrong values and wrong places.
//!
//! Constructors only: places and values in, diagnostics out.

use crate::diagnostic::{Diagnostic, Edit, did_you_mean};
use crate::source::Span;

pub fn unknown_attribute(at: Span, key: &str, known: &[&str]) -> Diagnostic {
    let d = Diagnostic::error("unknown-attribute", format!("no attribute named `{key}`"));
    let d = match did_you_mean(key, known.iter().copied()) {
        Some(near) => d.at(at, format!("did you mean `{near}`?")).fix(at, near),
        None => d.at(at, "not known"),
    };
    d.fact("attributes: order 2, noise 0.01 or 2%, unit \"m\"; for inputs hold, linear or cubic; for inputs and states delay 0.09; for states memory 0.3 or hidden")
}

pub fn attribute_elsewhere(at: Span, key: &str, keyword: &str) -> Diagnostic {
    let d = Diagnostic::error(
        "attribute-place",
        format!("`{key}` says nothing about {}", plural(keyword)),
    )
    .at(at, "has no meaning here")
    .remove(at);
    match key {
        "hold" | "linear" | "cubic" => d.help("it is for inputs: how they move between samples"),
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
    let near = value.floor().clamp(least.into(), most.into());
    Diagnostic::error(
        "attribute-value",
        format!("the order {value} does not exist"),
    )
    .at(at, format!("a whole number from {least} to {most}"))
    .help(match near as u8 {
        1 => "write `order 1` for a name with one derivative".to_string(),
        n => format!("write `order {n}` for a name with {n} derivatives"),
    })
    .fix(at, near.to_string())
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
    .remove(at)
}

/// `memory -0.3`
pub fn negative_memory(at: Span, seconds: f64) -> Diagnostic {
    Diagnostic::error(
        "attribute-value",
        format!("a memory of {seconds} s is no time"),
    )
    .at(at, "a number that is not negative")
    .help("leave `memory` out if it is not known; `memory 0` says that the noise is white")
    .remove(at)
    .fix(at, "0")
}

pub fn memory_in_discrete(at: Span, place: Span) -> Diagnostic {
    Diagnostic::error(
        "mixed-time",
        "a model about samples knows no memory of noise in seconds",
    )
    .at(at, "has no meaning here")
    .also(place, "makes it a model about samples")
    .help("remove it")
    .remove(at)
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
        false => d
            .help(format!("for a delay that is known write `delay {from}`"))
            .edit(Edit::Attribute(at, "delay", format!("delay {from}"))),
    }
}

pub fn delay_in_discrete(at: Span, place: Span, keyword: &str) -> Diagnostic {
    let d = Diagnostic::error(
        "mixed-time",
        "a model about samples has no delays in seconds",
    )
    .at(at, "has no meaning here")
    .also(place, "makes it a model about samples")
    .remove(at);
    match keyword {
        "input" => d.help(
            "remove it, and write the delay in the equations: `lag(u, 2)` is u two samples before",
        ),
        _ => d.help("remove it, and shift the column in the table by whole samples"),
    }
}

/// `whole` is the attribute; `examples` are possible replacements.
pub fn attribute_value(
    (at, whole): (Span, Span),
    key: &str,
    wanted: &str,
    examples: &[&str],
) -> Diagnostic {
    let d = Diagnostic::error("attribute-value", format!("`{key}` takes {wanted}"))
        .at(at, format!("{wanted} is missing"))
        .help(format!("write `{}`", examples.join("` or `")));
    examples.iter().fold(d, |d, example| d.fix(whole, *example))
}

/// `delay "0.1 s"`
pub fn attribute_text(at: Span, key: &str, example: &str) -> Diagnostic {
    Diagnostic::error("attribute-value", format!("`{key}` takes a number"))
        .at(at, "a number is missing")
        .help(format!("write `{key} {example}`"))
        .fix(at, example)
}

pub fn attribute_without_value(at: Span, key: &str) -> Diagnostic {
    Diagnostic::error("attribute-value", format!("`{key}` takes no value"))
        .at(at, "remove this")
        .help(format!("write `{key}`"))
        .fix(at, "")
}

pub fn two_courses(at: Span, before: &'static str) -> Diagnostic {
    Diagnostic::error(
        "attribute-value",
        "between its samples an input moves in one way",
    )
    .at(at, "contradicts the attribute before")
    .help("keep one of `hold`, `linear` and `cubic`")
    .remove(at)
    .edit(Edit::RemoveAttribute(at, before))
}

pub fn order_in_discrete(at: Span, place: Span) -> Diagnostic {
    Diagnostic::error("mixed-time", "a model about samples has no derivatives")
        .at(at, "declares derivatives")
        .also(place, "makes the model discrete")
        .help("remove `order`; earlier samples are `lag(x, 1)`")
        .remove(at)
}

pub fn unknown_attribute_of_unknown(at: Span, key: &str) -> Diagnostic {
    Diagnostic::error(
        "unknown-attribute",
        format!("an unknown constant has no attribute `{key}`"),
    )
    .at(at, "not `unit` and not `per run`")
    .help("remove it; the forms are `unknown k in 0.1..10, unit \"1/s\"` and `unknown L : per run`")
    .remove(at)
}
