//! Monomials of atoms as products: each atom gives the list of its powers.
//!
//! In: atoms as terms, and which exponents. Out: one product, or a union of some if their sum is bounded.

use std::sync::Arc;

use super::graded::{Degrees, Graded, pieces};
use super::list::{List, Unwieldy, components, multiply_out};
use super::product::Product;
use super::set::{Set, product_of};
use super::size::binomial;
use super::{Exponents, MAX_LIST};
use crate::term::Term;

/// Every product of powers of the atoms; these are distinct, and none is 1.
pub(super) fn monomials(atoms: &[Term], exponents: Exponents) -> Result<Set, Unwieldy> {
    let lists: Vec<Arc<List>> = atoms.iter().map(|a| List::new(vec![a.clone()])).collect();
    let groups = components(lists.iter());
    let groups = groups
        .iter()
        .map(|g| g.iter().filter_map(|i| atoms.get(*i)).collect::<Vec<_>>());
    let (from, to) = exponents.total;
    if to == u32::MAX {
        let lists: Result<Vec<Arc<List>>, Unwieldy> =
            groups.map(|g| tensor(&g, exponents.each)).collect();
        return product_of(lists?);
    }
    let groups: Vec<Vec<&Term>> = groups.collect();
    if from > 0 && groups.iter().any(|g| g.len() > 1) {
        // x·x² and x³ are one term of two degrees: only the least counts below a bound, any would above one.
        let count = binomial(atoms.len() as u128 + u128::from(to), u128::from(to));
        too_long(count)?;
        let all: Vec<&Term> = atoms.iter().collect();
        let kept = graded(&all, to)
            .into_iter()
            .filter(|(d, _)| *d >= u64::from(from));
        return Ok(Set::of(kept.map(|(_, t)| t).collect()));
    }
    let mut lists = Vec::with_capacity(groups.len());
    for group in &groups {
        let n = group.len() as u128;
        too_long(binomial(n + u128::from(to), u128::from(to)))?;
        lists.push(Graded::new(least_degrees(graded(group, to))));
    }
    let range = Degrees {
        from: from.into(),
        to: to.into(),
    };
    let products = pieces(&lists, range)?
        .into_iter()
        .map(Product::from_factors);
    Ok(Set::of_products(products.collect()))
}

fn too_long(count: u128) -> Result<(), Unwieldy> {
    if count > MAX_LIST {
        return Err(Unwieldy::List(count));
    }
    Ok(())
}

/// Each atom to the powers 0 … p.
fn tensor(atoms: &[&Term], p: u32) -> Result<Arc<List>, Unwieldy> {
    too_long(u128::from(p) + 1)?;
    let powers = |a: &&Term| List::new((0..=p).map(|k| a.pow(f64::from(k))).collect());
    let lists: Vec<Arc<List>> = atoms.iter().map(powers).collect();
    multiply_out(&lists)
}

/// Every product with a sum of exponents up to `most`, with that sum.
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

/// Equal terms once, with the least of their degrees.
fn least_degrees(mut entries: Vec<(u64, Term)>) -> Vec<(u64, Term)> {
    entries.sort_by(|a, b| a.1.cmp(&b.1).then(a.0.cmp(&b.0)));
    entries.dedup_by(|later, first| later.1 == first.1);
    entries
}
