//! A system as a list of equations, for languages that solve equations themselves.
//!
//! In: a program and the text of its terms. Out: equations as pairs of left and right side. A rate is a pair of names, a state and the
//! signal that is its derivative; how a derivative is written is left to the language.

use crate::code::infix::{Infix, Syntax};
use crate::code::program::{Body, Name, Program, Step};
use sidc_system::discovery::Rate;

/// Equations of a system.
pub(crate) struct EquationList {
    /// Subexpressions that are used more than once.
    pub named: Vec<(String, String)>,
    /// A state, and the signal that is its derivative.
    pub rates: Vec<(String, String)>,
    /// A highest derivative, and its right side, which may contain other highest derivatives.
    pub laws: Vec<(String, String)>,
    /// An output, and its value.
    pub outputs: Vec<(String, String)>,
}

/// `body` comes from [`Program::sides`].
pub(crate) fn equation_list<S: Syntax>(
    program: &Program,
    body: &Body,
    infix: &Infix<S>,
) -> EquationList {
    let form = &program.form;
    let named = body.steps.iter().filter_map(|step| match step {
        Step::Let(Name::Node(node), _) => Some((infix.name(Name::Node(*node)), infix.value(*node))),
        _ => None,
    });
    let rate = |rate: &Rate| match rate {
        Rate::State(i) => form.state.get(*i),
        Rate::Unknown(i) => form.unknowns.get(*i),
    };
    let rates = form.state.iter().zip(&form.rates);
    let rates = rates.filter_map(|(x, r)| Some((infix.signal(*x), infix.signal(*rate(r)?))));
    let (rows, outputs) = body
        .results
        .split_at(form.rows.len().min(body.results.len()));
    let laws = form.unknowns.iter().zip(rows);
    let laws = laws.filter_map(|(q, row)| Some((infix.signal(*q), infix.text(*row.last()?))));
    let outputs = form.outputs.iter().zip(outputs);
    let outputs =
        outputs.filter_map(|((s, _), row)| Some((infix.signal(*s), infix.text(*row.first()?))));
    EquationList {
        named: named.collect(),
        rates: rates.collect(),
        laws: laws.collect(),
        outputs: outputs.collect(),
    }
}

/// Rejects what a language for continuous time cannot express.
///
/// # Errors
/// The model is in discrete time.
pub(crate) fn check_continuous(language: &str, program: &Program) -> Result<(), String> {
    match program.discrete {
        true => Err(format!(
            "{language} is for continuous time here, and this model is in discrete time; --to python or --to c write its steps"
        )),
        false => Ok(()),
    }
}
