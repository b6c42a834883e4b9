//! Lists of terms: the factors of products.
//!
//! In: terms. Out: sorted lists that know their atoms and degrees, so that coprime lists (those without a common atom) are found
//! quickly. Never longer than the limit of the family [`LIBRARY`].

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::term::{Atom, Term};
use crate::thresholds::LIBRARY;

/// Distinct terms, sorted, with their atoms.
#[derive(Clone, Debug)]
pub(crate) struct TermList {
    terms: Vec<Term>,
    /// Every atom of the terms, sorted.
    atoms: Vec<Atom>,
    /// Least and largest degree.
    degrees: (f64, f64),
}

/// Why a set of products would take too much memory or time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LimitExceeded {
    /// A list of this many terms, from factors that share atoms.
    List(u128),
    /// A union of too many products.
    Products,
}

impl TermList {
    pub fn new(mut terms: Vec<Term>) -> Arc<TermList> {
        // Generators and products of sorted lists mostly come sorted.
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
        Arc::new(TermList {
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

    /// The part of a term over the atoms of this list.
    pub fn part(&self, term: &Term) -> Term {
        term.part(|atom| self.has_atom(atom))
    }

    pub fn filtered(&self, keep: impl Fn(&Term) -> bool) -> Arc<TermList> {
        TermList::new(self.terms.iter().filter(|t| keep(t)).cloned().collect())
    }

    /// Every term multiplied by `term`.
    pub fn times(&self, term: &Term) -> Arc<TermList> {
        TermList::new(self.terms.iter().map(|t| t.mul(term)).collect())
    }
}

/// Number of products of one term of each list, or `u128::MAX`.
pub(crate) fn size(lists: &[Arc<TermList>]) -> u128 {
    lists
        .iter()
        .fold(1, |n, list| n.saturating_mul(list.len() as u128))
}

/// Every product of one term of each list, as one list.
///
/// # Errors
/// More products than a list may have.
pub(crate) fn multiply_out(lists: &[Arc<TermList>]) -> Result<Arc<TermList>, LimitExceeded> {
    if let [one] = lists {
        return Ok(one.clone());
    }
    let size = size(lists);
    if size > LIBRARY.listed_terms {
        return Err(LimitExceeded::List(size));
    }
    Ok(TermList::new(products(lists)))
}

/// The products themselves, unsorted. The caller has checked their number.
pub(crate) fn products(lists: &[Arc<TermList>]) -> Vec<Term> {
    let mut terms = vec![Term::one()];
    for list in lists {
        terms = terms
            .iter()
            .flat_map(|a| list.terms.iter().map(move |b| a.mul(b)))
            .collect();
    }
    terms
}

/// Connected components of the lists, by index, where lists that share an atom are connected (union-find, Tarjan 1975). In the
/// order of their first lists.
pub(crate) fn components<'a>(lists: impl Iterator<Item = &'a Arc<TermList>>) -> Vec<Vec<usize>> {
    let mut group: Vec<usize> = Vec::new();
    let mut owner: BTreeMap<&Atom, usize> = BTreeMap::new();
    for (i, list) in lists.enumerate() {
        group.push(i);
        for atom in &list.atoms {
            if let Some(other) = owner.insert(atom, i) {
                merge_roots(&mut group, other, i);
            }
        }
    }
    let mut found: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for i in 0..group.len() {
        found.entry(find_root(&group, i)).or_default().push(i);
    }
    let mut found: Vec<Vec<usize>> = found.into_values().collect();
    found.sort_unstable();
    found
}

fn find_root(group: &[usize], mut i: usize) -> usize {
    while let Some(&above) = group.get(i).filter(|above| **above != i) {
        i = above;
    }
    i
}

fn merge_roots(group: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find_root(group, a), find_root(group, b));
    if let Some(above) = group.get_mut(a.max(b)) {
        *above = a.min(b);
    }
}
