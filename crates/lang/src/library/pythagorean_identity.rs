//! Linear dependence that is visible without data: cos² + sin² = 1.
//!
//! In: the set of an equation. Out: a note for each argument, since a library may well be dependent (the 6,561 terms of the pendulum
//! have 729 such identities); an error where the identity hides the target in its own library. Identities are counted on the factors
//! of products, and looked up in listed sets. Makes no product.

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::Diagnostic;
use crate::library::library_errors;
use crate::library::sets::inclusion_exclusion::Counter;
use crate::library::sets::product::Product;
use crate::library::sets::selection_rule::SelectionRule;
use crate::library::sets::term_list::TermList;
use crate::library::sets::term_set::TermSet;
use crate::model::{LibExpr, Model};
use crate::term::{Atom, Expr, Func, Language, Signal, SignalNames, Term};
use crate::thresholds::LIBRARY;

pub(crate) fn check(
    model: &Model,
    target: Signal,
    written: &LibExpr,
    set: &TermSet,
    rule: &SelectionRule,
) -> Vec<Diagnostic> {
    let squares = sine_squares(set);
    let lists = set.products().iter().flat_map(Product::factors);
    let size: usize = lists.map(|l| l.len()).sum();
    let (listed, mut left) = (is_listed(set), LIBRARY.identity_terms);
    let mut found = Vec::new();
    for (argument, terms) in &squares {
        let Some(pair) = PythagoreanPair::of(argument) else {
            continue;
        };
        if let Some(error) = hidden_target(model, target, written, (set, rule), &pair) {
            found.push(error);
            continue;
        }
        let count = if listed {
            Some(count_by_lookup(set, rule, &pair, terms))
        } else if size <= left {
            left -= size;
            count_by_intersection(set, rule, &pair.sin2, &pair.cos2)
        } else {
            None
        };
        let some = count.filter(|n| *n > 0);
        found.extend(some.map(|n| identity(model, written, &pair, n)));
    }
    found
}

/// sin² and cos² of one argument.
pub(crate) struct PythagoreanPair {
    pub sin2: Term,
    pub cos2: Term,
}

impl PythagoreanPair {
    pub fn of(argument: &Expr) -> Option<PythagoreanPair> {
        let square = |name| {
            let f = Func::named(name)?;
            let (_, t) = Expr::call(f, vec![argument.clone()]).into_term();
            Some(t.pow(2.0))
        };
        Some(PythagoreanPair {
            sin2: square("sin")?,
            cos2: square("cos")?,
        })
    }
}

/// The listed terms with a factor sin²(e), by e.
pub(crate) fn sine_squares(set: &TermSet) -> BTreeMap<&Expr, Vec<&Term>> {
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
    (set, rule): (&TermSet, &SelectionRule),
    pair: &PythagoreanPair,
) -> Option<Diagnostic> {
    let bare = Term::signal(target);
    let (with_sin, with_cos) = (bare.mul(&pair.sin2), bare.mul(&pair.cos2));
    // Both squares are even, so the rule admits both products or neither.
    (rule.admits(&with_sin) && set.contains(&with_sin) && set.contains(&with_cos)).then(|| {
        let language = Language(model);
        let (a, b) = (language.term(&with_sin), language.term(&with_cos));
        library_errors::target_by_identity(written.span, &model.name(target), &a, &b)
    })
}

fn identity(model: &Model, written: &LibExpr, pair: &PythagoreanPair, count: u128) -> Diagnostic {
    let language = Language(model);
    let (sin2, cos2) = (language.term(&pair.sin2), language.term(&pair.cos2));
    let identity = format!("`{sin2} + {cos2} = 1`");
    let example = format!("1, {sin2}, {cos2}");
    library_errors::dependent(written.span, &identity, &example, count)
}

/// True if every product of the set is a single list.
pub(crate) fn is_listed(set: &TermSet) -> bool {
    set.products().iter().all(|p| p.factors().len() == 1)
}

/// The same number as [`count_by_intersection`], counted term by term.
pub(crate) fn count_by_lookup(
    set: &TermSet,
    rule: &SelectionRule,
    pair: &PythagoreanPair,
    with_sine: &[&Term],
) -> u128 {
    let (over, turned) = (pair.sin2.pow(-1.0), pair.cos2.mul(&pair.sin2.pow(-1.0)));
    let there = |t: &&&Term| {
        set.contains(t) && set.contains(&t.mul(&over)) && set.contains(&t.mul(&turned))
    };
    let distinct: BTreeSet<&Term> = with_sine.iter().copied().collect();
    let admitted = distinct.iter().filter(|t| rule.admits(t));
    admitted.filter(there).count() as u128
}

/// Number of terms T·sin² for which T and T·cos² are in the set too; `None` if counting takes too long.
///
/// The sets {T·sin²}, {T}·sin² and {T·cos²}·sin²/cos² are products over the same factors, and so is their intersection. Both squares
/// are even, so the rule admits T and T·cos² wherever it admits T·sin².
pub(crate) fn count_by_intersection(
    set: &TermSet,
    rule: &SelectionRule,
    sin2: &Term,
    cos2: &Term,
) -> Option<u128> {
    let products = set.products();
    let with_sine: Vec<Product> = products
        .iter()
        .filter_map(|p| multiples_of(p, sin2))
        .collect();
    if with_sine.len() * products.len() > LIBRARY.identity_pairs {
        return None;
    }
    let moved = |by: &Term| -> Vec<Product> { products.iter().map(|p| p.times_term(by)).collect() };
    let plain = moved(sin2);
    let turned = moved(&sin2.mul(&cos2.pow(-1.0)));
    let one_group = products.iter().all(|p| p.group == 0);
    let mut all = Vec::new();
    for product in &with_sine {
        for t in &plain {
            let Some(pair) = product.intersection(t).ok()? else {
                continue;
            };
            for t in &turned {
                if let Some(triple) = pair.intersection(t).ok()? {
                    // Products of one group are disjoint, and so are their intersections.
                    let group = if one_group { 0 } else { all.len() };
                    all.push(triple.in_group(group));
                }
            }
        }
    }
    Counter::default().count(&all, rule)
}

/// The terms of a product that have exactly this power as a factor.
fn multiples_of(product: &Product, power: &Term) -> Option<Product> {
    let square = power.factors().next()?;
    let with = |list: &TermList| list.filtered(|t| t.factors().any(|factor| factor == square));
    let found = product.factors().iter().any(|l| l.has_atom(square.0));
    let factors = product
        .factors()
        .iter()
        .map(|list| match list.has_atom(square.0) {
            true => with(list),
            false => list.clone(),
        });
    let kept = Product::from_factors(factors.collect())
        .excluding(product.exclusions().iter().cloned())
        .in_group(product.group);
    (found && kept.size() > 0).then_some(kept)
}
