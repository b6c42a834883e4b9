//! Algebraic dependence that is visible without data: cos² + sin² = 1.
//!
//! A library may well be dependent (the 6,561-term pendulum has 729 such identities), so this is a note, once per pair of factors.
//! Only a target hidden in its own library is an error. Identities are counted on factors: no term is touched.

use super::count::Counter;
use super::errors;
use super::list::List;
use super::product::Product;
use super::rule::Rule;
use super::set::Set;
use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::{LibExpr, Model};
use crate::term::{Atom, Expr, Func, Language, Signal, SignalNames, Term};

/// Most pairs of products to compare: about a tenth of a second.
const MAX_PAIRS: usize = 50_000;

pub(super) fn check(
    model: &Model,
    target: Signal,
    written: &LibExpr,
    set: &Set,
    rule: &Rule,
) -> Vec<Diagnostic> {
    arguments(set)
        .iter()
        .filter_map(|argument| pythagoras(model, target, written, set, rule, argument))
        .collect()
}

/// Arguments `e` for which sin²(e) occurs, each once.
fn arguments(set: &Set) -> Vec<Expr> {
    let Some(sin) = Func::named("sin") else {
        return Vec::new();
    };
    let lists = set.products().iter().flat_map(Product::factors);
    let sines = |atom: &&Atom| matches!(atom, Atom::Call(f, _) if *f == sin);
    let lists = lists.filter(|list| list.atoms().iter().any(|atom| sines(&atom)));
    let mut found: Vec<Expr> = Vec::new();
    for (atom, p) in lists.flat_map(|l| l.terms()).flat_map(Term::factors) {
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

fn pythagoras(
    model: &Model,
    target: Signal,
    written: &LibExpr,
    set: &Set,
    rule: &Rule,
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
    // Both squares are even, so the rule admits both products or neither.
    if rule.admits(&with_sin) && set.contains(&with_sin) && set.contains(&with_cos) {
        let name = model.name(target);
        let (a, b) = (language.term(&with_sin), language.term(&with_cos));
        return Some(errors::target_by_identity(written.span, &name, &a, &b));
    }
    let count = identities(set, rule, &sin2, &cos2).filter(|n| *n > 0)?;
    let (sin2, cos2) = (language.term(&sin2), language.term(&cos2));
    let identity = format!("`{sin2} + {cos2} = 1`");
    let example = format!("1, {sin2}, {cos2}");
    Some(errors::dependent(written.span, &identity, &example, count))
}

/// Number of terms T·sin² for which T and T·cos² are there too; `None` where counting takes too long.
///
/// The sets {T·sin²}, {T}·sin² and {T·cos²}·sin²/cos² are products over the same factors, and so is what they have in common.
/// The rule admits T and T·cos² wherever it admits T·sin².
pub(super) fn identities(set: &Set, rule: &Rule, sin2: &Term, cos2: &Term) -> Option<u128> {
    let products = set.products();
    let with_sine: Vec<Product> = products.iter().filter_map(|p| having(p, sin2)).collect();
    if with_sine.len() * products.len() > MAX_PAIRS {
        return None;
    }
    let moved = |by: &Term| -> Vec<Product> { products.iter().map(|p| p.shifted(by)).collect() };
    let plain = moved(sin2);
    let turned = moved(&sin2.mul(&cos2.pow(-1.0)));
    let one_group = products.iter().all(|p| p.group == 0);
    let mut all = Vec::new();
    for product in &with_sine {
        for t in &plain {
            let Some(pair) = product.and(t).ok()? else {
                continue;
            };
            for t in &turned {
                if let Some(triple) = pair.and(t).ok()? {
                    // Products of one group have nothing in common, nor have these then.
                    let group = if one_group { 0 } else { all.len() };
                    all.push(triple.in_group(group));
                }
            }
        }
    }
    Counter::default().count(&all, rule)
}

/// The terms of a product that have this very power as a factor.
fn having(product: &Product, power: &Term) -> Option<Product> {
    let square = power.factors().next()?;
    let with = |list: &List| list.filtered(|t| t.factors().any(|factor| factor == square));
    let found = product.factors().iter().any(|l| l.has_atom(square.0));
    let factors = product
        .factors()
        .iter()
        .map(|list| match list.has_atom(square.0) {
            true => with(list),
            false => list.clone(),
        });
    let kept = Product::from_factors(factors.collect())
        .with_holes(product.holes().iter().cloned())
        .in_group(product.group);
    (found && kept.size() > 0).then_some(kept)
}
