//! A block of products: how slots, left and right factors are numbered.
//!
//! In: ranges of factors. Out: slots, and back. Holds no numbers of columns.

use std::ops::Range;

/// Every product of some left columns with some right ones; the right one varies fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    pub first_slot: usize,
    pub left: Range<usize>,
    pub right: Range<usize>,
}

impl Block {
    pub fn slots(&self) -> usize {
        self.left.len() * self.right.len()
    }

    /// The slot of a left and a right factor.
    pub(super) fn slot(&self, left: usize, right: usize) -> usize {
        let (l, r) = (left - self.left.start, right - self.right.start);
        self.first_slot + l * self.right.len() + r
    }

    /// First slot, left and right column of a block that follows.
    pub fn ends(&self) -> (usize, usize, usize) {
        (
            self.first_slot + self.slots(),
            self.left.end,
            self.right.end,
        )
    }

    /// The left and the right factor of a slot of the block.
    pub fn factors(&self, slot: usize) -> [usize; 2] {
        let (place, rights) = (slot - self.first_slot, self.right.len());
        [
            self.left.start + place / rights,
            self.right.start + place % rights,
        ]
    }
}
