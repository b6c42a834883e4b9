//! The slot of a term in blocks: one look-up in each side, no search among products.
//!
//! In: blocks. Out: slots of terms and of products of lists. Keeps no terms, only fingerprints of them.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use std::sync::Arc;

use crate::library::block::Block;
use crate::library::sets::term_list::{TermList, products};
use crate::term::{Atom, Term};

#[derive(Clone, Debug)]
pub(crate) struct SlotIndex {
    entries: Vec<BlockIndex>,
}

/// One block's sides and its first slot.
#[derive(Clone, Debug)]
struct BlockIndex {
    left: SideIndex,
    right: SideIndex,
    start: usize,
}

#[derive(Clone, Debug)]
struct SideIndex {
    atoms: BTreeSet<Atom>,
    by_fingerprint: HashMap<u64, usize>,
}

impl SlotIndex {
    pub fn new(blocks: &[Block]) -> SlotIndex {
        let mut start = 0;
        let mut entries = Vec::with_capacity(blocks.len());
        for block in blocks {
            let (left, right) = (SideIndex::new(&block.left), SideIndex::new(&block.right));
            entries.push(BlockIndex { left, right, start });
            start += block.slots();
        }
        SlotIndex { entries }
    }

    /// The first slot of `term` in the blocks of a range; `blocks` must be those that the index was made from.
    pub fn find(&self, blocks: &[Block], range: Range<usize>, term: &Term) -> Option<usize> {
        let pairs = self.entries.iter().zip(blocks);
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

    /// Appends the slots of every product over `lists` in block `at`. False if a list has atoms of both sides or of neither: then
    /// its terms must be looked up one by one.
    pub fn slots_of_product(
        &self,
        blocks: &[Block],
        at: usize,
        lists: &[Arc<TermList>],
        out: &mut Vec<usize>,
    ) -> bool {
        let (Some(place), Some(block)) = (self.entries.get(at), blocks.get(at)) else {
            return false;
        };
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for list in lists {
            if place.left.has_all_atoms(list) {
                left.push(list.clone());
            } else if place.right.has_all_atoms(list) {
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

impl SideIndex {
    fn has_all_atoms(&self, list: &TermList) -> bool {
        list.atoms().iter().all(|atom| self.atoms.contains(atom))
    }

    /// Positions of the products over lists that are terms of this side.
    fn all(&self, terms: &[Term], lists: &[Arc<TermList>]) -> Vec<usize> {
        let all = products(lists).into_iter();
        all.filter_map(|t| Some(self.find(terms, &t)?.0)).collect()
    }

    fn new(terms: &[Term]) -> SideIndex {
        let mut atoms: BTreeSet<&Atom> = BTreeSet::new();
        for term in terms {
            atoms.extend(term.factors().map(|(atom, _)| atom));
        }
        SideIndex {
            atoms: atoms.into_iter().cloned().collect(),
            by_fingerprint: terms.iter().map(Term::fingerprint).zip(0..).collect(),
        }
    }

    /// The position of the part of a term over this side's atoms, and how many factors that part has.
    fn find(&self, terms: &[Term], term: &Term) -> Option<(usize, usize)> {
        let part = term.part(|atom| self.atoms.contains(atom));
        let place = *self.by_fingerprint.get(&part.fingerprint())?;
        (terms.get(place) == Some(&part)).then(|| (place, part.factors().len()))
    }
}
