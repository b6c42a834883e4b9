//! Errors in `when y < 0 : dy -> -e*dy`.
//!
//! Constructors only.

use crate::diagnostic::Diagnostic;
use crate::source::Span;

pub fn reset_in_discrete(at: Span, discrete: Span) -> Diagnostic {
    Diagnostic::error("reset", "samples do not jump between each other")
        .at(at, "an instant within a step")
        .also(discrete, "the model is about samples")
        .help("write a case of the map with `step(…)`")
}

pub fn reset_at_equality(at: Span, [left, right]: [&str; 2]) -> Diagnostic {
    Diagnostic::error("reset", "a condition becomes true from one side")
        .at(at, "from above or from below?")
        .help(format!(
            "write `when {left} < {right} : …` or `when {left} > {right} : …`"
        ))
}

pub fn reset_without_state(at: Span) -> Diagnostic {
    Diagnostic::error("reset", "this condition has no state in it")
        .at(at, "the equations do not move it")
        .help("compare a state with something: `when y < 0 : dy -> -0.8*dy`")
}

pub fn reset_by_target(at: Span, equation: Span, target: &str) -> Diagnostic {
    Diagnostic::error(
        "reset",
        format!("`{target}` has no one value where states jump"),
    )
    .at(at, "the rate before or after the jump?")
    .also(equation, "its equation")
    .help("use states, inputs and constants")
}

pub fn jump_of_target(at: Span, equation: Span, target: &str) -> Diagnostic {
    Diagnostic::error(
        "reset",
        format!("`{target}` follows from its equation, and cannot be set"),
    )
    .at(at, "not a state")
    .also(equation, "its equation")
    .help("set a state, or a derivative below the target")
}

pub fn jump_of_other(at: Span, name: &str, is_state: bool) -> Diagnostic {
    let d = Diagnostic::error("reset", format!("`{name}` cannot jump"));
    match is_state {
        true => d.at(at, "no equation moves this state").help(format!(
            "write an equation for `{name}`, or leave the line out"
        )),
        false => d
            .at(at, "not a state")
            .help("states jump: `when y < 0 : dy -> -0.8*dy`"),
    }
}
