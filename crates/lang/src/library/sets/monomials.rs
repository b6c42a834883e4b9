//! Sets of monomials as products: each atom gives the list of its powers.
//!
//! In: atoms as terms, and their exponents. Out: one product, or a union of products if the total degree is bounded.

use std::sync::Arc;

use crate::library::generators::generator::Exponents;
use crate::library::sets::combinatorics::binomial;
use crate::library::sets::degree_bounded::{Degrees, GradedList, bounded_products};
use crate::library::sets::product::Product;
use crate::library::sets::term_list::{LimitExceeded, TermList, components, multiply_out};
use crate::library::sets::term_set::{TermSet, product_of};
use crate::term::Term;
use crate::thresholds::LIBRARY;

/// Every product of powers of the atoms within the exponents. The atoms are distinct, and none is 1.
///
/// # Errors
/// Atoms that share factors and make too long a list; too many products.
pub(crate) fn monomials(atoms: &[Term], exponents: Exponents) -> Result<TermSet, LimitExceeded> {
    let lists: Vec<Arc<TermList>> = atoms
        .iter()
        .map(|a| TermList::new(vec![a.clone()]))
        .collect();
    let groups = components(lists.iter());
    let groups = groups
        .iter()
        .map(|g| g.iter().filter_map(|i| atoms.get(*i)).collect::<Vec<_>>());
    let (from, to) = exponents.total;
    if to == u32::MAX {
        let lists: Result<Vec<Arc<TermList>>, LimitExceeded> =
            groups.map(|g| tensor_powers(&g, exponents.each)).collect();
        return product_of(lists?);
    }
    let groups: Vec<Vec<&Term>> = groups.collect();
    if from > 0 && groups.iter().any(|g| g.len() > 1) {
        // x·x² and x³ are one term of two degrees. For an upper bound the smaller decides; for a lower bound either may,
        // so the terms are listed.
        let count = binomial(atoms.len() as u128 + u128::from(to), u128::from(to));
        check_length(count)?;
        let all: Vec<&Term> = atoms.iter().collect();
        let kept = graded(&all, to)
            .into_iter()
            .filter(|(d, _)| *d >= u64::from(from));
        return Ok(TermSet::of(kept.map(|(_, t)| t).collect()));
    }
    let mut lists = Vec::with_capacity(groups.len());
    for group in &groups {
        let n = group.len() as u128;
        check_length(binomial(n + u128::from(to), u128::from(to)))?;
        lists.push(GradedList::new(least_degrees(graded(group, to))));
    }
    let range = Degrees {
        from: from.into(),
        to: to.into(),
    };
    let products = bounded_products(&lists, range)?
        .into_iter()
        .map(Product::from_factors);
    Ok(TermSet::of_products(products.collect()))
}

fn check_length(count: u128) -> Result<(), LimitExceeded> {
    if count > LIBRARY.listed_terms {
        return Err(LimitExceeded::List(count));
    }
    Ok(())
}

/// Each atom to the powers 0 … p.
fn tensor_powers(atoms: &[&Term], p: u32) -> Result<Arc<TermList>, LimitExceeded> {
    check_length(u128::from(p) + 1)?;
    let powers = |a: &&Term| TermList::new((0..=p).map(|k| a.pow(f64::from(k))).collect());
    let lists: Vec<Arc<TermList>> = atoms.iter().map(powers).collect();
    multiply_out(&lists)
}

/// Every product with a sum of exponents up to `most`, each with its sum.
fn graded(atoms: &[&Term], most: u32) -> Vec<(u64, Term)> {
    let mut all = vec![(0, Term::one())];
    for atom in atoms {
        let powers: Vec<Term> = (0..=most).map(|k| atom.pow(f64::from(k))).collect();
        let mut next = Vec::with_capacity(all.len() * 2);
        for (degree, term) in &all {
            let room = (u64::from(most) - degree) as usize;
            let steps = (*degree..).zip(powers.iter().take(room + 1));
            next.extend(steps.map(|(sum, power)| (sum, term.mul(power))));
        }
        all = next;
    }
    all
}

/// Each term once, with the smallest of its degrees.
fn least_degrees(mut entries: Vec<(u64, Term)>) -> Vec<(u64, Term)> {
    entries.sort_by(|a, b| a.1.cmp(&b.1).then(a.0.cmp(&b.0)));
    entries.dedup_by(|later, first| later.1 == first.1);
    entries
}
