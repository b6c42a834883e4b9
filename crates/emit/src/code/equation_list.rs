//! A system as a list of equations, for languages that solve them on their own.
//!
//! In: a program and the text of its terms. Out: equations as pairs of texts; every one gives its left side. Derivatives are not written
//! here: a rate is a pair of names, a component of the state and what its rate is.

use crate::code::infix::{Infix, Syntax};
use crate::code::program::{Body, Name, Program, Step};
use sidc_system::discovery::Rate;

/// Equations of a system.
pub(crate) struct EquationList {
    /// Subexpressions that are used more than once.
    pub named: Vec<(String, String)>,
    /// A component of the state, and the signal that its rate is.
    pub rates: Vec<(String, String)>,
    /// A highest derivative, and what it was found to be; others may stand in it.
    pub laws: Vec<(String, String)>,
    /// An output, and what it is.
    pub outputs: Vec<(String, String)>,
}

/// `body` is that of [`Program::sides`].
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

/// What a language of equations in continuous time cannot say.
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
