//! Errors in equations and constraints, and notes on models without errors.
//!
//! Constructors only, except for the notes, which are selected here.

use crate::ast::File;
use crate::check::scope::Scope;
use crate::diagnostic::{Diagnostic, Edit};
use crate::model::{Model, Var, VarKind};
use crate::source::Span;
use crate::term::VarId;
use crate::thresholds::MESSAGES;

/// `dx - y ~ …`; `sum` is the text to put before the right side.
pub fn not_a_target(
    at: Span,
    (target, sign): (&str, &str),
    (right, sum): (Span, String),
) -> Diagnostic {
    Diagnostic::error("target", "an equation is about one signal")
        .at(at, "not a derivative, a next sample or an output")
        .help(format!(
            "write `{target} {sign} {sum}…`, with everything else on the right"
        ))
        .edit_all([
            Edit::Replace(at, target.to_string()),
            Edit::Replace(right.before(), sum),
        ])
}

pub fn next_of_other(at: Span, var: &Var) -> Diagnostic {
    Diagnostic::error("target", format!("`{}` is not a state", var.name))
        .at(at, "only a state has a next sample")
        .also_if_known(var.span, "declared here")
        .help(format!(
            "declare `state {}`; an output has an equation of its own: `y ~ …`",
            var.name
        ))
        .edit_all(var.span.map(|s| Edit::Redeclare(s, "state")))
}

pub fn let_as_target(at: Span, name: &str, definition: Option<Span>) -> Diagnostic {
    Diagnostic::error("target", format!("`{name}` is defined by `let`"))
        .at(at, "cannot have an equation")
        .also_if_known(definition, "defined here")
        .help(format!("declare it instead: `output {name}`"))
        .edit_all(definition.map(|d| Edit::Redeclare(d, "output")))
}

/// `x ~ …` for a state, an input or time.
pub fn wrong_target(at: Span, name: &str, var: &Var, discrete: bool) -> Diagnostic {
    let what = match var.kind {
        VarKind::Time => "time",
        VarKind::State => "a state",
        VarKind::Input => "an input",
        VarKind::Output => "an output",
        VarKind::Param => "a parameter",
        VarKind::Unknown => "an unknown constant",
    };
    let d = Diagnostic::error(
        "target",
        format!("`{name}` is {what}, and cannot have an equation"),
    )
    .at(
        at,
        "an equation is about a derivative, a next sample or an output",
    )
    .also_if_known(var.span, "declared here");
    match var.kind {
        VarKind::State => {
            let target = match discrete {
                true => format!("next {}", var.name),
                false => "d".repeat(usize::from(var.order)) + &var.name,
            };
            d.help(format!(
                "write `{target} ~ …`, or declare `output {}` if it follows from other states at the same instant",
                var.name
            ))
            .fix(at, target)
        }
        VarKind::Input => d
            .help(format!(
                "what is to be explained is declared as `output {}`",
                var.name
            ))
            .edit_all(var.span.map(|s| Edit::Redeclare(s, "output"))),
        _ => d.help("declare a state or an output for it"),
    }
}

pub fn second_equation(at: Span, first: Span, name: &str) -> Diagnostic {
    Diagnostic::error("second-equation", format!("a second equation for `{name}`"))
        .at(at, "again here")
        .also(first, "first here")
        .help("join the libraries with `+`, or put the candidates in two model files")
        .edit(Edit::Join(first, at))
}

/// `sought` are edits that turn the part into candidates or remove it.
pub fn known_with_target(at: Span, target: Span, name: &str, sought: Vec<Edit>) -> Diagnostic {
    Diagnostic::error("known-part", format!("the known part contains its own target `{name}`"))
        .at(at, "known, and sought")
        .also(target, "the target")
        .help(format!("bring `{name}` to the left by hand, or leave the part to the search: a library may have products of it, `{name} * <x>`"))
        .edit_all(sought)
}

/// `dx = poly(x; 2)`
pub fn known_library(at: Span, sign: Option<Span>) -> Diagnostic {
    let d = Diagnostic::error(
        "library-in-expression",
        "`=` states a known expression, and this is a library",
    )
    .at(at, "candidates, not an expression")
    .help("to search the library write `~` instead of `=`");
    sign.into_iter().fold(d, |d, sign| d.fix(sign, "~"))
}

/// `ours` is the correct spelling; `added`, the same with its sign, replaces `whole`.
pub fn known_subtracted(at: Span, whole: Span, ours: &str, added: &str) -> Diagnostic {
    Diagnostic::error("known-part", "`known(…)` is added as it stands")
        .at(at, "no `-`, power or `;` here")
        .help(format!("put the sign inside: `{ours}`"))
        .fix(whole, added)
}

pub fn required_subtracted(at: Span, whole: Span, added: &str) -> Diagnostic {
    Diagnostic::error("misplaced-word", "`required(…)` is added, as it stands")
        .at(at, "taken away, raised, or with a `;`")
        .help("write `dx ~ required(x, x^3) + poly(x; 5)`; numbers and powers stand inside")
        .fix(whole, added)
}

pub fn minus_from_nothing(at: Span) -> Diagnostic {
    Diagnostic::error("difference-removes-nothing", "this `-` has no library before it")
        .at(at, "taken from nothing")
        .help("a known part is no library: put its sign inside, `known(-x)`, and remove terms from a library")
}

pub fn constraint_without_coefficient(at: Span) -> Diagnostic {
    Diagnostic::error(
        "constraint",
        "a constraint is about at least one coefficient",
    )
    .at(at, "no `coef(…)`, or they cancel")
    .help("write `constrain coef(dx, x) < 0`, or leave the line out")
    .edit(Edit::RemoveStatement(at))
}

/// `said` is the place of the whole attribute.
pub fn per_run_words(at: Span, said: Span) -> Diagnostic {
    Diagnostic::error("per-run", "what may be said of a coefficient is `per run`")
        .at(at, "something else")
        .help("write `per run`, or `constrain coef(dx, x) < 0`")
        .fix(said, "per run")
}

pub fn per_run_of_no_coefficient(at: Span) -> Diagnostic {
    Diagnostic::error("per-run", "`per run` is said of coefficients")
        .at(at, "no `coef(…)`")
        .help("leave it out, or write `coef(dx, x) : per run`")
        .remove(at)
}

pub fn constraint_not_linear(at: Span) -> Diagnostic {
    Diagnostic::error("constraint", "a constraint is linear in the coefficients")
        .at(at, "not a sum of coefficients times numbers")
        .help("multiply out, as in `coef(dx, x) = 2*coef(dy, y)`, or leave the line out")
        .edit(Edit::RemoveStatement(at))
}

pub fn coefficient_of_no_equation(at: Span, example: &str) -> Diagnostic {
    Diagnostic::error("constraint", "there is no equation for this")
        .at(at, "no target of an equation")
        .help(format!(
            "the first argument is a target such as `{example}`"
        ))
        .fix(at, example)
}

pub fn coefficient_of_known(at: Span, equation: Span) -> Diagnostic {
    Diagnostic::error(
        "constraint",
        "this equation is known and has no coefficients to find",
    )
    .at(at, "stated, not asked")
    .also(equation, "with `=`")
    .help("constrain an equation written with `~`")
}

/// `coef(dx, 2*x)`; `ours` is the place and the text of the coefficient of x alone.
pub fn coefficient_of_multiple(at: Span, weight: f64, ours: Option<(Span, String)>) -> Diagnostic {
    let d = Diagnostic::error(
        "constraint",
        format!("the term carries the number {weight}"),
    )
    .at(at, "terms have no numeric factor");
    match ours {
        Some((whole, ours)) => d
            .help(format!(
                "leave the number out here and divide the coefficient by it: `{ours}`"
            ))
            .fix(whole, ours),
        None => d.help("leave the number out here"),
    }
}

/// A model without an equation; suggests one made of its declared names.
pub fn no_equation(at: Option<Span>, model: &Model, file: &File) -> Diagnostic {
    let states: Vec<&Var> = model.vars_of(VarKind::State).map(|(_, v)| v).collect();
    let inputs = model.vars_of(VarKind::Input).map(|(_, v)| v.name.clone());
    let example = match states.first() {
        None => "state x`, then `dx ~ poly(x; 3)".to_string(),
        Some(first) => {
            let names: Vec<String> = states
                .iter()
                .flat_map(|v| (0..usize::from(v.order.max(1))).map(|k| "d".repeat(k) + &v.name))
                .chain(inputs)
                .take(MESSAGES.example_names)
                .collect();
            let target = "d".repeat(usize::from(first.order.max(1))) + &first.name;
            format!("{target} ~ poly({}; 2)", names.join(", "))
        }
    };
    let end = Span::new(file.id, file.text.len(), file.text.len());
    let last = at.unwrap_or(end);
    let at = at.unwrap_or(Span::new(file.id, 0, 0));
    let d = Diagnostic::error("no-equation", "the model has no equation")
        .at(at, "nothing is asked up to here")
        .help(format!("add a line such as `{example}`"));
    let begun = last != end || !(file.text.is_empty() || file.text.ends_with('\n'));
    let line_break = if begun { "\n" } else { "" };
    match states.is_empty() {
        true => d.fix(
            last.after(),
            format!("{line_break}state x\ndx ~ poly(x; 3)"),
        ),
        false => d.fix(at.after(), format!("\n{example}")),
    }
}

/// Notes on states without an equation and on names that nothing uses: legal, but perhaps not meant.
pub fn unused_declarations(model: &Model, scope: &Scope) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    let driven: Vec<&Var> = model
        .vars_of(VarKind::State)
        .filter(|(id, _)| !model.has_equation(*id))
        .map(|(_, var)| var)
        .collect();
    out.extend(driven_states(&driven));
    for (i, var) in model.vars.iter().enumerate() {
        let id = VarId(i as u16);
        let target = model.has_equation(id);
        let idle = matches!(var.kind, VarKind::Input | VarKind::Param | VarKind::Unknown)
            && !scope.used_vars.contains(&id);
        let asked_nothing = var.kind == VarKind::Output && !target;
        if let (Some(span), true) = (var.span, idle || asked_nothing) {
            out.push(unused(span, &var.name, asked_nothing));
        }
    }
    for (name, l) in &scope.lets {
        if !scope.used_lets.contains(name) {
            out.push(unused(l.span, name, false));
        }
    }
    out
}

/// One note for all states without an equation, because a model of part of a large system has many.
fn driven_states(states: &[&Var]) -> Option<Diagnostic> {
    let shown = MESSAGES.listed_names;
    let at = states.first()?.span?;
    let names: Vec<String> = states
        .iter()
        .take(shown)
        .map(|v| format!("`{}`", v.name))
        .collect();
    let (subject, label) = match states.len() {
        1 => (
            format!("the state {} has", names.join(", ")),
            "driven by its measurement in simulation",
        ),
        n if n <= shown => (
            format!("the states {} have", names.join(", ")),
            "driven by their measurements in simulation",
        ),
        n => (
            format!("{n} states, {}, …, have", names.join(", ")),
            "driven by their measurements in simulation",
        ),
    };
    Some(Diagnostic::note("driven-state", format!("{subject} no equation")).at(at, label))
}

pub fn unused(at: Span, name: &str, output: bool) -> Diagnostic {
    if output {
        return Diagnostic::note(
            "unused-name",
            format!("the output `{name}` has no equation"),
        )
        .at(at, "declared here");
    }
    Diagnostic::note("unused-name", format!("`{name}` is never used")).at(at, "defined here")
}
