//! The candidate terms of one equation, kept as products of short lists.
//!
//! In: blocks. Out: terms by slot, one at a time. A library of millions of terms takes the memory of its factors.

use crate::term::{Signal, Term};

/// Every product of a term on the left with one on the right. Block after block these are the library's slots, the right
/// term varying fastest.
#[derive(Clone, Debug)]
pub struct Block {
    pub left: Vec<Term>,
    pub right: Vec<Term>,
}

/// The candidate terms of one equation, each in a slot of its own; a slot may be empty.
#[derive(Clone, Debug, Default)]
pub struct Library {
    blocks: Vec<Block>,
    /// Slots whose term is excluded or stands in an earlier slot too; rising.
    empty: Vec<usize>,
}

impl Library {
    /// A library of listed terms: distinct, in the order of their slots.
    pub fn listed(terms: Vec<Term>) -> Library {
        Library {
            blocks: vec![Block {
                left: terms,
                right: vec![Term::one()],
            }],
            empty: Vec::new(),
        }
    }

    /// A library of products, block after block; `empty` are the slots that are no candidates, rising.
    pub fn products(blocks: Vec<Block>, empty: Vec<usize>) -> Library {
        debug_assert!(empty.is_sorted_by(|a, b| a < b));
        Library { blocks, empty }
    }

    /// Number of terms.
    pub fn len(&self) -> usize {
        self.slots() - self.empty.len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of slots: columns of Φ.
    pub fn slots(&self) -> usize {
        self.blocks.iter().map(Block::slots).sum()
    }

    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Slots without a term, rising.
    pub fn empty_slots(&self) -> &[usize] {
        &self.empty
    }

    /// The product that stands in a slot; `None` past the last one. Empty slots have a term too, which is not a candidate.
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

    /// Every term with its slot.
    pub fn terms(&self) -> impl Iterator<Item = (usize, Term)> {
        let products = self.blocks.iter().flat_map(|b| {
            b.left
                .iter()
                .flat_map(move |l| b.right.iter().map(move |r| l.mul(r)))
        });
        let mut empty = self.empty.iter().copied().peekable();
        products
            .enumerate()
            .filter(move |(slot, _)| empty.next_if_eq(slot).is_none())
    }

    /// Every term that occurs as a factor of a block: together they have all signals and functions of the library.
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

impl Block {
    pub fn slots(&self) -> usize {
        self.left.len() * self.right.len()
    }
}
