//! Where a term stands in blocks: a look into each side, not a search among products.
//!
//! In: blocks. Out: the slot of a term. Keeps no term of its own.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

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
}

impl Side {
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
