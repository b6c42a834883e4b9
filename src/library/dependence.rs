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
    let arguments = arguments(library);
    if arguments.is_empty() {
        return Vec::new();
    }
    let known = Known::new(library);
    arguments
        .iter()
        .filter_map(|argument| pythagoras(model, target, written, &known, argument))
        .collect()
}

/// Arguments `e` for which sin²(e) occurs, each once.
fn arguments(library: &Library) -> Vec<Expr> {
    let Some(sin) = Func::named("sin") else {
        return Vec::new();
    };
    let mut found: Vec<Expr> = Vec::new();
    for (atom, p) in library.factors().flat_map(Term::factors) {
        if let Atom::Call(f, args) = atom
            && *f == sin
            && p == 2.0
            && let Some(argument) = args.first()
            && !found.contains(argument)
        {
            found.push(argument.clone());
        }
    }
    found.sort();
    found
}

/// The library's terms, to be asked for by fingerprint.
struct Known {
    terms: Vec<Term>,
    fingerprints: Vec<u64>,
    sorted: Vec<u64>,
}

impl Known {
    fn new(library: &Library) -> Self {
        let terms: Vec<Term> = library.terms().map(|(_, t)| t).collect();
        let fingerprints: Vec<u64> = terms.iter().map(Term::fingerprint).collect();
        let mut sorted = fingerprints.clone();
        sorted.sort_unstable();
        Known {
            terms,
            fingerprints,
            sorted,
        }
    }

    fn has(&self, fingerprint: u64) -> bool {
        self.sorted.binary_search(&fingerprint).is_ok()
    }

    /// Terms T·sin² for which T and T·cos² are there too.
    fn identities(&self, sin2: &Term, cos2: &Term) -> usize {
        let (with_sin2, with_cos2) = (sin2.fingerprint(), cos2.fingerprint());
        let square = sin2.factors().next();
        self.terms
            .iter()
            .zip(&self.fingerprints)
            .filter(|(t, _)| t.factors().any(|factor| Some(factor) == square))
            .filter(|(_, f)| {
                let plain = f.wrapping_sub(with_sin2);
                self.has(plain) && self.has(plain.wrapping_add(with_cos2))
            })
            .count()
    }
}

fn pythagoras(
    model: &Model,
    target: Signal,
    written: &LibExpr,
    known: &Known,
    argument: &Expr,
) -> Option<Diagnostic> {
    let square = |name| {
        let f = Func::named(name)?;
        let (_, t) = Expr::call(f, vec![argument.clone()]).into_term();
        Some(t.pow(2.0))
    };
    let (sin2, cos2) = (square("sin")?, square("cos")?);
    let language = Language(model);
    let bare = Term::signal(target);
    let (with_sin, with_cos) = (bare.mul(&sin2), bare.mul(&cos2));
    if known.has(with_sin.fingerprint()) && known.has(with_cos.fingerprint()) {
        let name = model.name(target);
        let (a, b) = (language.term(&with_sin), language.term(&with_cos));
        return Some(errors::target_by_identity(written.span, &name, &a, &b));
    }
    let count = known.identities(&sin2, &cos2);
    if count == 0 {
        return None;
    }
    let (sin2, cos2) = (language.term(&sin2), language.term(&cos2));
    let identity = format!("`{sin2} + {cos2} = 1`");
    let example = format!("1, {sin2}, {cos2}");
    Some(errors::dependent(written.span, &identity, &example, count))
}
