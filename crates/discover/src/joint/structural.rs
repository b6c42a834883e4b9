//! Constants that no readings can tell, as errors of the model before any search.
//!
//! In: a model, the problem. Out: diagnostics with the parameters of which only a combination acts, and a way out. Never looks at an answer.

use super::hidden_states::{ANY_SCALE, coefficient};
use crate::trajectory::{
    Parameter, Problem, UnidentifiableDirection, structurally_unidentifiable_directions,
};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::Model;
use sidc_lang::term::SignalNames;

/// An error for each direction in which constants can change while nothing that is read does.
pub fn structurally_unidentifiable(model: &Model, problem: &Problem) -> Vec<Diagnostic> {
    let directions = structurally_unidentifiable_directions(problem, &model.unknowns);
    directions
        .iter()
        .map(|d| error(model, problem, d))
        .collect()
}

fn error(model: &Model, problem: &Problem, direction: &UnidentifiableDirection) -> Diagnostic {
    let name = |p: &Parameter| match p {
        Parameter::Constant(k) => model.variable(model.unknowns[*k].var).to_string(),
        Parameter::Coefficient(column) => coefficient(model, problem, *column),
    };
    let moves = direction.parameters.iter();
    let moves: Vec<(String, f64)> = moves.map(|(p, power)| (name(p), *power)).collect();
    let mut constants = direction.parameters.iter().filter_map(|(p, _)| match p {
        Parameter::Constant(k) => Some(model.unknowns[*k].var),
        Parameter::Coefficient(_) => None,
    });
    let first = constants.next();
    let unknown = first.map_or_else(String::new, |v| model.variable(v).to_string());
    let text = format!(
        "no readings can tell {unknown}: {}",
        why(&moves, direction.starts)
    );
    let d = Diagnostic::error("unidentifiable-constant", text);
    let d = match first.and_then(|v| model.var(v)).and_then(|v| v.span) {
        Some(span) => d.at(span, "declared here"),
        None => d,
    };
    d.help(match (&moves[..], direction.starts) {
        ([_], false) => format!("let {unknown} act on what is read, or leave it out"),
        _ => way_out(model, &unknown, moves.len()),
    })
}

fn why(moves: &[(String, f64)], starts: bool) -> String {
    let same = |a: f64, b: f64| (a - b).abs() < 0.01;
    match moves {
        [_] if starts => ANY_SCALE.into(),
        [_] => "nothing that is read depends on it".into(),
        [(_, a), (other, b)] if same(*a, -*b) => {
            format!("only its product with {other} acts on what is read")
        }
        [(_, a), (other, b)] if same(*a, *b) => {
            format!("only its ratio to {other} acts on what is read")
        }
        [first @ .., (last, _)] => {
            let first: Vec<&str> = first.iter().map(|(name, _)| name.as_str()).collect();
            format!(
                "only a combination of {} and {last} acts on what is read",
                first.join(", ")
            )
        }
        [] => String::new(),
    }
}

fn way_out(model: &Model, unknown: &str, parameters: usize) -> String {
    let hidden: Vec<&str> = model
        .hidden_states()
        .map(|(_, v)| v.name.as_str())
        .collect();
    let state = match parameters {
        1 => format!("state it, as in `let {unknown} = 1`"),
        _ => format!("state one of them, as in `let {unknown} = 1`"),
    };
    match hidden.is_empty() {
        true => state,
        false => format!("{state}, or measure {}", hidden.join(", ")),
    }
}
