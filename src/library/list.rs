//! A list of terms: what a product takes one of.
//!
//! In: terms. Out: lists that know their atoms and degrees, so that lists without a common atom are told apart at a glance.
//! Never longer than [`MAX_LIST`].

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::MAX_LIST;
use crate::term::{Atom, Term};

/// Distinct terms, sorted, with their atoms.
#[derive(Clone, Debug)]
pub(super) struct List {
    terms: Vec<Term>,
    /// Every atom of the terms, sorted.
    atoms: Vec<Atom>,
    /// Least and largest degree.
    degrees: (f64, f64),
}

/// What factored sets cannot do in reasonable memory and time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unwieldy {
    /// Factors that share atoms make a list of so many terms.
    List(u128),
    /// A set falls apart into too many products.
    Products,
}

impl List {
    pub fn new(mut terms: Vec<Term>) -> Arc<List> {
        // Generators and products of sorted lists mostly come so.
        if !terms.is_sorted_by(|a, b| a < b) {
            terms.sort_unstable();
            terms.dedup();
        }
        let mut atoms: BTreeSet<&Atom> = BTreeSet::new();
        let (mut least, mut largest) = (f64::INFINITY, 0f64);
        for term in &terms {
            atoms.extend(term.factors().map(|(atom, _)| atom));
            let degree = term.degree();
            (least, largest) = (least.min(degree), largest.max(degree));
        }
        let atoms = atoms.into_iter().cloned().collect();
        Arc::new(List {
            terms,
            atoms,
            degrees: (least, largest),
        })
    }

    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    pub fn len(&self) -> usize {
        self.terms.len()
    }

    pub fn atoms(&self) -> &[Atom] {
        &self.atoms
    }

    pub fn degrees(&self) -> (f64, f64) {
        self.degrees
    }

    pub fn has_atom(&self, atom: &Atom) -> bool {
        self.atoms.binary_search(atom).is_ok()
    }

    pub fn contains(&self, term: &Term) -> bool {
        self.terms.binary_search(term).is_ok()
    }

    /// The part of a term that this list is about.
    pub fn part(&self, term: &Term) -> Term {
        term.part(|atom| self.has_atom(atom))
    }

    pub fn filtered(&self, keep: impl Fn(&Term) -> bool) -> Arc<List> {
        List::new(self.terms.iter().filter(|t| keep(t)).cloned().collect())
    }

    /// Every term times one.
    pub fn times(&self, term: &Term) -> Arc<List> {
        List::new(self.terms.iter().map(|t| t.mul(term)).collect())
    }
}

/// Number of products of one term of each list, or `u128::MAX`.
pub(super) fn size(lists: &[Arc<List>]) -> u128 {
    lists
        .iter()
        .fold(1, |n, list| n.saturating_mul(list.len() as u128))
}

/// Every product of one term of each list, as one list.
///
/// # Errors
/// More products than a list may have.
pub(super) fn multiply_out(lists: &[Arc<List>]) -> Result<Arc<List>, Unwieldy> {
    if let [one] = lists {
        return Ok(one.clone());
    }
    let size = size(lists);
    if size > MAX_LIST {
        return Err(Unwieldy::List(size));
    }
    Ok(List::new(products(lists)))
}

/// The products themselves, in no order; their number is seen to by the caller.
pub(super) fn products(lists: &[Arc<List>]) -> Vec<Term> {
    let mut terms = vec![Term::one()];
    for list in lists {
        terms = terms
            .iter()
            .flat_map(|a| list.terms.iter().map(move |b| a.mul(b)))
            .collect();
    }
    terms
}

/// The lists by index, those together that share atoms directly or through others; in the order of their first lists.
pub(super) fn components<'a>(lists: impl Iterator<Item = &'a Arc<List>>) -> Vec<Vec<usize>> {
    let mut group: Vec<usize> = Vec::new();
    let mut owner: BTreeMap<&Atom, usize> = BTreeMap::new();
    for (i, list) in lists.enumerate() {
        group.push(i);
        for atom in &list.atoms {
            if let Some(other) = owner.insert(atom, i) {
                join(&mut group, other, i);
            }
        }
    }
    let mut found: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for i in 0..group.len() {
        found.entry(root(&group, i)).or_default().push(i);
    }
    let mut found: Vec<Vec<usize>> = found.into_values().collect();
    found.sort_unstable();
    found
}

fn root(group: &[usize], mut i: usize) -> usize {
    while let Some(&above) = group.get(i).filter(|above| **above != i) {
        i = above;
    }
    i
}

fn join(group: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(group, a), root(group, b));
    if let Some(above) = group.get_mut(a.max(b)) {
        *above = a.min(b);
    }
}
