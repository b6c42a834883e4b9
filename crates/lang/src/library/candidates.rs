//! The candidate terms of one equation, kept as blocks of products.
//!
//! In: blocks. Out: terms by slot, slots by term. A library of millions of terms takes the memory of its factors; products are made
//! one at a time.

use std::sync::OnceLock;

use crate::library::block::Block;
use crate::library::slot_index::SlotIndex;
use crate::term::{Signal, Term};

/// The candidate terms of one equation. Each has a slot, the number of its column in the dictionary Φ; a slot may be empty.
#[derive(Clone, Debug, Default)]
pub struct Library {
    blocks: Vec<Block>,
    /// Slots whose term is excluded or has an earlier slot; ascending.
    empty: Vec<usize>,
    /// Slots of the terms that are part of every answer; ascending.
    required: Vec<usize>,
    /// Number of terms before the selection rule was applied.
    before: Option<u128>,
    /// Made at the first look-up.
    index: OnceLock<SlotIndex>,
}

impl Library {
    /// Distinct terms; `empty` ascends.
    pub(crate) fn new(blocks: Vec<Block>, empty: Vec<usize>) -> Library {
        debug_assert!(empty.is_sorted_by(|a, b| a < b));
        Library {
            blocks,
            empty,
            ..Library::default()
        }
    }

    /// A library of distinct terms, in the order of their slots.
    pub fn listed(terms: Vec<Term>) -> Library {
        Library::new(vec![Block::listed(terms)], Vec::new())
    }

    /// The same library with these slots in every answer; they ascend.
    pub fn requiring(mut self, required: Vec<usize>) -> Library {
        debug_assert!(required.is_sorted_by(|a, b| a < b));
        self.required = required;
        self
    }

    /// Slots of the terms that are part of every answer, ascending.
    pub fn required(&self) -> &[usize] {
        &self.required
    }

    pub(crate) fn pruned_from(mut self, before: Option<u128>) -> Library {
        self.before = before;
        self
    }

    /// A library of blocks; `empty` are the slots without a candidate, ascending.
    pub fn products(blocks: Vec<Block>, empty: Vec<usize>) -> Library {
        Library::new(blocks, empty)
    }

    /// The same library with these slots empty, except for required ones.
    pub fn without(&self, slots: &[usize]) -> Library {
        let mut empty = self.empty.clone();
        let kept = |slot: &usize| self.required.binary_search(slot).is_err();
        empty.extend(slots.iter().copied().filter(kept));
        empty.sort_unstable();
        empty.dedup();
        Library {
            blocks: self.blocks.clone(),
            before: self.before,
            required: self.required.clone(),
            ..Library::new(Vec::new(), empty)
        }
    }

    /// Number of terms.
    pub fn len(&self) -> usize {
        self.slots() - self.empty.len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of terms as written, before `symmetry` and `limit` statements pruned them; `None` if there are no such statements.
    pub fn before(&self) -> Option<u128> {
        self.before
    }

    /// Number of slots: columns of the dictionary Φ.
    pub fn slots(&self) -> usize {
        self.blocks.iter().map(Block::slots).sum()
    }

    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Slots without a candidate, ascending.
    pub fn empty_slots(&self) -> &[usize] {
        &self.empty
    }

    pub fn is_empty_slot(&self, slot: usize) -> bool {
        self.empty.binary_search(&slot).is_ok()
    }

    /// The term of a slot; `None` past the last one. Empty slots have a term too, which is not a candidate.
    pub fn term(&self, slot: usize) -> Option<Term> {
        let mut place = slot;
        for block in &self.blocks {
            if place < block.slots() {
                let left = block.left.get(place / block.right.len())?;
                return Some(left.mul(block.right.get(place % block.right.len())?));
            }
            place -= block.slots();
        }
        None
    }

    /// The slot of a term, if it is a candidate. The first call indexes the lists; later ones take a few look-ups for each block.
    pub fn contains(&self, term: &Term) -> Option<usize> {
        let index = self.index.get_or_init(|| SlotIndex::new(&self.blocks));
        let (all, mut from) = (self.blocks.len(), 0);
        while from < all {
            let slot = index.find(&self.blocks, from..all, term)?;
            if !self.is_empty_slot(slot) {
                return Some(slot);
            }
            // Excluded here, it may be a candidate in a later block.
            from = 1 + self.block_of(slot)?;
        }
        None
    }

    /// The block of a slot.
    fn block_of(&self, slot: usize) -> Option<usize> {
        let mut end = 0;
        self.blocks.iter().position(|b| {
            end += b.slots();
            slot < end
        })
    }

    /// Every term with its slot.
    pub fn terms(&self) -> impl Iterator<Item = (usize, Term)> {
        let products = self.blocks.iter().flat_map(Block::terms);
        let mut empty = self.empty.iter().copied().peekable();
        products
            .enumerate()
            .filter(move |(slot, _)| empty.next_if_eq(slot).is_none())
    }

    /// The slots of all terms, those of lowest degree first.
    pub fn by_degree(&self) -> Vec<usize> {
        let mut all: Vec<(f64, usize)> = self.terms().map(|(s, t)| (t.degree(), s)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all.into_iter().map(|(_, slot)| slot).collect()
    }

    /// A library of the terms in these slots and the required ones, listed.
    pub fn with_only(&self, slots: &[usize]) -> Library {
        let mut kept: Vec<usize> = slots.iter().chain(&self.required).copied().collect();
        kept.sort_unstable();
        kept.dedup();
        let terms = kept.iter().filter_map(|slot| self.term(*slot)).collect();
        let place = |slot: &usize| kept.binary_search(slot).ok();
        let required = self.required.iter().filter_map(place).collect();
        Library::listed(terms).requiring(required)
    }

    /// Every term that is a factor of a block. Together they mention all signals and functions of the library.
    pub fn factors(&self) -> impl Iterator<Item = &Term> {
        self.blocks
            .iter()
            .flat_map(|b| b.left.iter().chain(&b.right))
    }

    /// Every signal of the library, each once, sorted.
    pub fn signals(&self) -> Vec<Signal> {
        let mut all = Vec::new();
        for term in self.factors() {
            term.for_each_signal(&mut |s| all.push(s));
        }
        all.sort_unstable();
        all.dedup();
        all
    }
}
