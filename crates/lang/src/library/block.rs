//! A block of a library: every product of a term of one list with a term of another.
//!
//! In: two lists of terms. Out: their products in the order of slots. Makes one product at a time.

use crate::term::Term;

/// Every product of a term on the left with one on the right. The blocks of a library, one after another, are its slots;
/// within a block the right term varies fastest.
#[derive(Clone, Debug)]
pub struct Block {
    pub left: Vec<Term>,
    pub right: Vec<Term>,
}

impl Block {
    pub(crate) fn listed(terms: Vec<Term>) -> Block {
        Block {
            left: terms,
            right: vec![Term::one()],
        }
    }

    pub fn slots(&self) -> usize {
        self.left.len() * self.right.len()
    }

    /// True if the block is a plain list of terms.
    pub fn is_list(&self) -> bool {
        self.right.len() == 1
    }

    /// Every product, in the order of slots.
    pub fn terms(&self) -> impl Iterator<Item = Term> {
        let left = self.left.iter();
        left.flat_map(move |l| self.right.iter().map(move |r| l.mul(r)))
    }
}
