//! Errors in the use of hidden states.

use crate::diagnostic::{Diagnostic, Edit};
use crate::model::Var;
use crate::source::Span;

/// `key` is the attribute that needs a sensor; `None` if it is the data entry at `at`.
pub fn hidden_sensor(
    (at, declared): (Span, Option<Span>),
    name: &str,
    what: &str,
    key: Option<&'static str>,
) -> Diagnostic {
    let d = Diagnostic::error("hidden-state", format!("{what} of a hidden state"))
        .at(at, format!("nothing measures {name}"))
        .help(format!("remove {what}, or `hidden` if {name} has a sensor"));
    let d = match key {
        Some(key) => d.edit(Edit::RemoveAttribute(at, key)),
        None => d.remove(at),
    };
    d.edit_all(declared.map(|s| Edit::RemoveAttribute(s, "hidden")))
}

pub fn hidden_in_discrete(at: Span, name: &str) -> Diagnostic {
    Diagnostic::error("hidden-state", "in discrete time no state is hidden")
        .at(at, format!("{name} needs readings"))
        .help("look back in the readings instead: `lag(x, 1)`, `lag(u, 1)`")
}

pub fn hidden_without_equation(at: Span, var: &Var) -> Diagnostic {
    let name = &var.name;
    let target = "d".repeat(usize::from(var.order.max(1))) + name;
    Diagnostic::error(
        "hidden-state",
        format!("the hidden state {name} has no equation"),
    )
    .at(at, "nothing measures it, and nothing says how it moves")
    .help(format!(
        "say how it moves, as in `{target} = (u - {name})/tau` with `unknown tau`, or ask for it: `{target} ~ <u, {name}>`"
    ))
}

pub fn all_hidden(at: Span) -> Diagnostic {
    Diagnostic::error("hidden-state", "every state with an equation is hidden")
        .at(at, "what it does shows in no reading")
        .help("a state that is measured has to depend on it: give that an equation")
}
