//! The terms of an equation that the model itself states, as part of a result.
//!
//! In: right-hand sides. Out: terms with fixed coefficients. Never estimates anything.

use sidc_lang::library::known_terms;
use sidc_lang::model::{Model, RightSide};
use sidc_lang::term::{Signal, Term};
use sidc_system::discovery::{Equation, FoundTerm, Status};

/// The terms that the model states.
pub(crate) fn fixed_terms(right: &RightSide) -> Vec<(f64, Term)> {
    match right {
        RightSide::Known(e) => known_terms([e]),
        RightSide::Search { known, .. } => known_terms(known.iter().map(|(e, _)| e)),
    }
}

/// Whether the data decide about an equation that the model gives: it holds unknown constants, or all equations are given.
pub(crate) fn is_estimated_if_given(model: &Model, right: &RightSide) -> bool {
    let unknown = |t: &Term| {
        model
            .unknowns
            .iter()
            .any(|u| t.mentions(Signal::new(u.var)))
    };
    let is_given = |right: &RightSide| match right {
        RightSide::Known(_) => true,
        RightSide::Search { library, .. } => library.is_none(),
    };
    model.equations.iter().all(|e| is_given(&e.right))
        || fixed_terms(right).iter().any(|(_, t)| unknown(t))
}

/// An equation that the model states completely.
pub(crate) fn stated(target: Signal, terms: Vec<(f64, Term)>) -> Equation {
    Equation {
        target,
        terms: terms.into_iter().map(fixed).collect(),
        status: Status::Known,
        reasons: Vec::new(),
        evidence: None,
        path: Vec::new(),
    }
}

/// A known term as a result prints it.
pub(crate) fn fixed((coefficient, term): (f64, Term)) -> FoundTerm {
    FoundTerm {
        term,
        coefficient,
        fixed: true,
        standard_error: None,
        evidence: None,
        runs: Vec::new(),
    }
}
