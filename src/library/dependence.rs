//! Algebraic dependence that is visible without data: cos² + sin² = 1.
//!
//! A library may well be dependent (the 6,561-term pendulum has 729 such identities), so this is a note, once per pair of factors.
//! Only a target hidden in its own library is an error.

use super::{Library, errors};
use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::{LibExpr, Model};
use crate::term::{Atom, Expr, Func, Language, Signal, SignalNames, Term};

pub(super) fn check(
    model: &Model,
    target: Signal,
    written: &LibExpr,
    library: &Library,
) -> Vec<Diagnostic> {
    arguments(library)
        .iter()
        .filter_map(|argument| pythagoras(model, target, written, library, argument))
        .collect()
}

/// Arguments `e` for which sin(e) occurs, each once.
fn arguments(library: &Library) -> Vec<Expr> {
    let Some(sin) = Func::named("sin") else {
        return Vec::new();
    };
    let mut found: Vec<Expr> = library
        .terms
        .iter()
        .flat_map(|t| t.factors())
        .filter_map(|(atom, p)| match atom {
            Atom::Call(f, args) if *f == sin && p == 2.0 => args.first().cloned(),
            _ => None,
        })
        .collect();
    found.sort();
    found.dedup();
    found
}

fn pythagoras(
    model: &Model,
    target: Signal,
    written: &LibExpr,
    library: &Library,
    argument: &Expr,
) -> Option<Diagnostic> {
    let square = |name| {
        let f = Func::named(name)?;
        let (_, t) = Expr::call(f, vec![argument.clone()]).into_term();
        Some(t.pow(2.0))
    };
    let (sin2, cos2) = (square("sin")?, square("cos")?);
    let language = Language(model);
    let (with_sin, with_cos) = {
        let bare = Term::signal(target);
        (bare.mul(&sin2), bare.mul(&cos2))
    };
    let degrees: Vec<f64> = library.terms.iter().map(Term::degree).collect();
    let has = |t: &Term| {
        let degree = t.degree();
        let from = degrees.partition_point(|d| *d < degree);
        let to = degrees.partition_point(|d| *d <= degree);
        let alike = library.terms.get(from..to).unwrap_or(&[]);
        alike.binary_search(t).is_ok()
    };
    if has(&with_sin) && has(&with_cos) {
        let name = model.name(target);
        let (a, b) = (language.term(&with_sin), language.term(&with_cos));
        return Some(errors::target_by_identity(written.span, &name, &a, &b));
    }
    // Only a term with sin² in it can be one of three; most have none, and looking terms up is what costs.
    let sin2_atom = sin2.factors().next().map(|(a, _)| a.clone());
    let without_sin2 = sin2.pow(-1.0);
    let count = library
        .terms
        .iter()
        .filter(|t| {
            t.factors()
                .any(|(a, p)| p >= 2.0 && Some(a) == sin2_atom.as_ref())
        })
        .map(|t| t.mul(&without_sin2))
        .filter(|t| has(t) && has(&t.mul(&cos2)))
        .count();
    if count == 0 {
        return None;
    }
    let (sin2, cos2) = (language.term(&sin2), language.term(&cos2));
    let identity = format!("`{sin2} + {cos2} = 1`");
    let example = format!("1, {sin2}, {cos2}");
    Some(errors::dependent(written.span, &identity, &example, count))
}
