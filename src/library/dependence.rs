//! Algebraic dependence that is visible without data: cos² + sin² = 1.
//!
//! A library may well be dependent (the 6,561-term pendulum has 729 such identities), so this is a note, once per pair of factors.
//! Only a target hidden in its own library is an error. Identities of factors are counted on the factors: no product is
//! made; those of a list are looked up.

use std::collections::{BTreeMap, BTreeSet};

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
/// Most terms of lists to go through, for all arguments together: about a second.
const MAX_TERMS: usize = 1_000_000;

pub(super) fn check(
    model: &Model,
    target: Signal,
    written: &LibExpr,
    set: &Set,
    rule: &Rule,
) -> Vec<Diagnostic> {
    let squares = squares(set);
    let lists = set.products().iter().flat_map(Product::factors);
    let size: usize = lists.map(|l| l.len()).sum();
    let (listed, mut left) = (is_listed(set), MAX_TERMS);
    let mut found = Vec::new();
    for (argument, terms) in &squares {
        let Some(pair) = Pair::of(argument) else {
            continue;
        };
        if let Some(error) = hidden_target(model, target, written, (set, rule), &pair) {
            found.push(error);
            continue;
        }
        let count = if listed {
            Some(looked_up(set, rule, &pair, terms))
        } else if size <= left {
            left -= size;
            identities(set, rule, &pair.sin2, &pair.cos2)
        } else {
            None
        };
        let some = count.filter(|n| *n > 0);
        found.extend(some.map(|n| identity(model, written, &pair, n)));
    }
    found
}

/// sin² and cos² of one argument.
pub(super) struct Pair {
    pub sin2: Term,
    pub cos2: Term,
}

impl Pair {
    pub fn of(argument: &Expr) -> Option<Pair> {
        let square = |name| {
            let f = Func::named(name)?;
            let (_, t) = Expr::call(f, vec![argument.clone()]).into_term();
            Some(t.pow(2.0))
        };
        Some(Pair {
            sin2: square("sin")?,
            cos2: square("cos")?,
        })
    }
}

/// The terms of lists with a factor sin²(e), by e.
pub(super) fn squares(set: &Set) -> BTreeMap<&Expr, Vec<&Term>> {
    let mut found: BTreeMap<&Expr, Vec<&Term>> = BTreeMap::new();
    let Some(sin) = Func::named("sin") else {
        return found;
    };
    let lists = set.products().iter().flat_map(Product::factors);
    let sine = |atom: &Atom| matches!(atom, Atom::Call(f, _) if *f == sin);
    let lists = lists.filter(|list| list.atoms().iter().any(sine));
    for term in lists.flat_map(|l| l.terms()) {
        for (atom, p) in term.factors() {
            if let Atom::Call(f, args) = atom
                && *f == sin
                && p == 2.0
                && let Some(argument) = args.first()
            {
                found.entry(argument).or_default().push(term);
            }
        }
    }
    found
}

fn hidden_target(
    model: &Model,
    target: Signal,
    written: &LibExpr,
    (set, rule): (&Set, &Rule),
    pair: &Pair,
) -> Option<Diagnostic> {
    let bare = Term::signal(target);
    let (with_sin, with_cos) = (bare.mul(&pair.sin2), bare.mul(&pair.cos2));
    // Both squares are even, so the rule admits both products or neither.
    (rule.admits(&with_sin) && set.contains(&with_sin) && set.contains(&with_cos)).then(|| {
        let language = Language(model);
        let (a, b) = (language.term(&with_sin), language.term(&with_cos));
        errors::target_by_identity(written.span, &model.name(target), &a, &b)
    })
}

fn identity(model: &Model, written: &LibExpr, pair: &Pair, count: u128) -> Diagnostic {
    let language = Language(model);
    let (sin2, cos2) = (language.term(&pair.sin2), language.term(&pair.cos2));
    let identity = format!("`{sin2} + {cos2} = 1`");
    let example = format!("1, {sin2}, {cos2}");
    errors::dependent(written.span, &identity, &example, count)
}

/// Whether the terms of lists are the terms of the set.
pub(super) fn is_listed(set: &Set) -> bool {
    set.products().iter().all(|p| p.factors().len() == 1)
}

/// As [`identities`], one by one.
pub(super) fn looked_up(set: &Set, rule: &Rule, pair: &Pair, with_sine: &[&Term]) -> u128 {
    let (over, turned) = (pair.sin2.pow(-1.0), pair.cos2.mul(&pair.sin2.pow(-1.0)));
    let there = |t: &&&Term| {
        set.contains(t) && set.contains(&t.mul(&over)) && set.contains(&t.mul(&turned))
    };
    let distinct: BTreeSet<&Term> = with_sine.iter().copied().collect();
    let admitted = distinct.iter().filter(|t| rule.admits(t));
    admitted.filter(there).count() as u128
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
