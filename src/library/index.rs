//! Where a term stands in blocks: a look into each side, not a search among products.
//!
//! In: blocks. Out: the slot of a term. Keeps no term of its own.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use std::sync::Arc;

use super::list::{List, products};
use super::terms::Block;
use crate::term::{Atom, Term};

#[derive(Clone, Debug)]
pub(super) struct Index {
    places: Vec<Place>,
}

/// One block's sides and its first slot.
#[derive(Clone, Debug)]
struct Place {
    left: Side,
    right: Side,
    start: usize,
}

#[derive(Clone, Debug)]
struct Side {
    atoms: BTreeSet<Atom>,
    by_fingerprint: HashMap<u64, usize>,
}

impl Index {
    pub fn new(blocks: &[Block]) -> Index {
        let mut start = 0;
        let mut places = Vec::with_capacity(blocks.len());
        for block in blocks {
            let (left, right) = (Side::new(&block.left), Side::new(&block.right));
            places.push(Place { left, right, start });
            start += block.slots();
        }
        Index { places }
    }

    /// The first slot of `term` in the blocks of a range; `blocks` are those that the index was made of.
    pub fn find(&self, blocks: &[Block], range: Range<usize>, term: &Term) -> Option<usize> {
        let pairs = self.places.iter().zip(blocks);
        pairs
            .skip(range.start)
            .take(range.len())
            .find_map(|(place, block)| {
                let (i, left) = place.left.find(&block.left, term)?;
                let (j, right) = place.right.find(&block.right, term)?;
                let whole = left + right == term.factors().len();
                whole.then(|| place.start + i * block.right.len() + j)
            })
    }

    /// Appends the slots in a block of every product over lists, and is true; false if some list lies on neither side alone.
    pub fn product(
        &self,
        blocks: &[Block],
        at: usize,
        lists: &[Arc<List>],
        out: &mut Vec<usize>,
    ) -> bool {
        let (Some(place), Some(block)) = (self.places.get(at), blocks.get(at)) else {
            return false;
        };
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for list in lists {
            if place.left.has_all(list) {
                left.push(list.clone());
            } else if place.right.has_all(list) {
                right.push(list.clone());
            } else {
                return false;
            }
        }
        let (left, right) = (
            place.left.all(&block.left, &left),
            place.right.all(&block.right, &right),
        );
        for i in left {
            let row = place.start + i * block.right.len();
            out.extend(right.iter().map(|j| row + j));
        }
        true
    }
}

impl Side {
    fn has_all(&self, list: &List) -> bool {
        list.atoms().iter().all(|atom| self.atoms.contains(atom))
    }

    /// The places of the products over lists that stand here.
    fn all(&self, terms: &[Term], lists: &[Arc<List>]) -> Vec<usize> {
        let all = products(lists).into_iter();
        all.filter_map(|t| Some(self.find(terms, &t)?.0)).collect()
    }

    fn new(terms: &[Term]) -> Side {
        let mut atoms: BTreeSet<&Atom> = BTreeSet::new();
        for term in terms {
            atoms.extend(term.factors().map(|(atom, _)| atom));
        }
        Side {
            atoms: atoms.into_iter().cloned().collect(),
            by_fingerprint: terms.iter().map(Term::fingerprint).zip(0..).collect(),
        }
    }

    /// The place of the term's own part, and how many factors that part has.
    fn find(&self, terms: &[Term], term: &Term) -> Option<(usize, usize)> {
        let part = term.part(|atom| self.atoms.contains(atom));
        let place = *self.by_fingerprint.get(&part.fingerprint())?;
        (terms.get(place) == Some(&part)).then(|| (place, part.factors().len()))
    }
}
