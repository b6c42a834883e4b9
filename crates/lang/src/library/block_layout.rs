//! A set of terms → the blocks of a library: two sides of similar length, pruned, no term twice.
//!
//! In: a set, the selection rule of its equation, a limit on memory. Out: a [`Library`]. Sizes are known by arithmetic before
//! anything is made, and what the rule excludes is never made.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use crate::library::block::Block;
use crate::library::candidates::Library;
use crate::library::sets::degree_bounded::{GradedList, bounded_products};
use crate::library::sets::product::Product;
use crate::library::sets::selection_rule::{ParityBits, SelectionRule};
use crate::library::sets::term_list::{LimitExceeded, TermList, products, size};
use crate::library::sets::term_set::TermSet;
use crate::library::slot_index::SlotIndex;
use crate::term::Term;
use crate::thresholds::LIBRARY;

/// Memory that one library may take.
#[derive(Clone, Copy)]
pub(crate) struct MemoryShare {
    pub bytes: u64,
    /// Number of equations that share the memory equally.
    pub of: u64,
}

/// Why a set cannot become a library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LayoutError {
    /// Number of terms, and bytes they need.
    Memory(u128, u128),
    LimitExceeded(LimitExceeded),
}

impl From<LimitExceeded> for LayoutError {
    fn from(why: LimitExceeded) -> Self {
        LayoutError::LimitExceeded(why)
    }
}

/// Bytes of a slot: the length of its column.
pub(crate) const SLOT_BYTES: u128 = 2;
/// Bytes of an empty slot besides: its number.
const EMPTY_SLOT_BYTES: u128 = 8;
/// Approximate bytes of a term in a list, with its factors.
const TERM_BYTES: u128 = 160;

/// The lists whose products are the left and right terms of blocks.
struct Sides {
    left: Vec<Arc<TermList>>,
    right: Vec<Arc<TermList>>,
}

/// The blocks made so far.
struct Layout<'a> {
    rule: &'a SelectionRule,
    budget: Budget,
    /// Blocks of fewer slots are listed term by term.
    least: usize,
    listed: Vec<Term>,
    blocks: Vec<Block>,
}

/// Bytes needed so far, and their limit.
struct Budget {
    slots: u128,
    bytes: u128,
    limit: u128,
}

impl Budget {
    fn need(&mut self, bytes: u128) -> Result<(), LayoutError> {
        self.bytes = self.bytes.saturating_add(bytes);
        if self.bytes > self.limit || self.slots > (isize::MAX as u128) {
            return Err(LayoutError::Memory(self.slots, self.bytes));
        }
        Ok(())
    }
}

/// Lays out a set. A small one becomes one list, in order of degree.
///
/// # Errors
/// More bytes than `memory`; a set that falls into too many products or too long lists.
pub(crate) fn lay_out(
    set: &TermSet,
    rule: &SelectionRule,
    memory: u64,
) -> Result<Library, LayoutError> {
    let all = ordered(set, rule)?;
    let sizes = all.iter().map(|p| rule.size(p.factors()));
    let slots = sizes.fold(0, u128::saturating_add);
    let mut budget = Budget {
        slots,
        bytes: 0,
        limit: memory.into(),
    };
    budget.need(slots.saturating_mul(SLOT_BYTES))?;
    let mut layout = Layout {
        rule,
        budget,
        least: match slots <= LIBRARY.small_set {
            true => usize::MAX,
            false => LIBRARY.small_block,
        },
        listed: Vec::new(),
        blocks: Vec::new(),
    };
    let mut ranges = Vec::with_capacity(all.len());
    for (i, product) in all.iter().enumerate() {
        let others = all.get(..i).unwrap_or_default().iter();
        let before: Vec<&Product> = others.filter(|p| p.group != product.group).collect();
        ranges.push(layout.place(product, &before)?);
    }
    let shift = layout.put_listed_first();
    let mut empty = Vec::new();
    let mut index = None;
    for (i, (product, range)) in all.iter().zip(ranges).enumerate() {
        let range = range.start + shift..range.end + shift;
        let before = all.get(..i).unwrap_or_default().iter();
        let before = before.filter(|p| p.group != product.group);
        for other in product.exclusions().iter().chain(before) {
            if !range.is_empty() {
                let index = index.get_or_insert_with(|| SlotIndex::new(&layout.blocks));
                empty.extend(layout.slots_of(product, other, range.clone(), index)?);
            }
        }
    }
    empty.sort_unstable();
    empty.dedup();
    Ok(Library::new(layout.blocks, empty))
}

/// The products, largest first, without terms of no definite parity; products inside larger ones are left out.
fn ordered(set: &TermSet, rule: &SelectionRule) -> Result<Vec<Product>, LayoutError> {
    let mut all = Vec::with_capacity(set.products().len());
    for product in set.products() {
        let lists = product
            .factors()
            .iter()
            .map(|l| rule.with_definite_parity(l))
            .collect();
        let kept = Product::from_factors(lists)
            .excluding(product.exclusions().iter().cloned())
            .in_group(product.group);
        if rule.size(kept.factors()) > 0 {
            all.push(kept);
        }
    }
    all.sort_by_cached_key(|p| Reverse(p.size()));
    let mut out: Vec<Product> = Vec::with_capacity(all.len());
    for product in all {
        let mut inside = false;
        for larger in out.iter().filter(|p| p.group != product.group) {
            inside = inside || larger.is_superset(&product)?;
        }
        if !inside {
            out.push(product);
        }
    }
    Ok(out)
}

impl Layout<'_> {
    /// Makes the blocks of a product without the terms of the products before it. Returns which blocks they are.
    fn place(
        &mut self,
        product: &Product,
        before: &[&Product],
    ) -> Result<Range<usize>, LayoutError> {
        let start = self.blocks.len();
        let all = self.sides(product)?;
        for sides in &all {
            let terms = size(&sides.left).saturating_add(size(&sides.right));
            self.budget.need(terms.saturating_mul(TERM_BYTES))?;
        }
        for sides in all {
            self.add(&sides, |term| {
                !product.exclusions().iter().any(|h| h.contains(term))
                    && !before.iter().any(|p| p.contains(term))
            })?;
        }
        Ok(start..self.blocks.len())
    }

    /// A product as products within the bound on degrees, each split in two sides.
    fn sides(&self, product: &Product) -> Result<Vec<Sides>, LimitExceeded> {
        let pieces = match self.rule.degrees() {
            None => vec![product.factors().to_vec()],
            Some(range) => {
                let graded: Vec<GradedList> = product
                    .factors()
                    .iter()
                    .map(|l| GradedList::of(l))
                    .collect();
                bounded_products(&graded, range)?
            }
        };
        Ok(pieces.into_iter().map(balanced_split).collect())
    }

    /// Adds the blocks of two sides. Small blocks are listed term by term, as far as the terms satisfy `keep`.
    fn add(&mut self, sides: &Sides, keep: impl Fn(&Term) -> bool) -> Result<(), LimitExceeded> {
        for block in self.blocks_of(sides)? {
            let degenerate = block.left.len() < 2 || block.right.len() < 2;
            if degenerate || block.slots() < self.least {
                self.listed.extend(block.terms().filter(&keep));
            } else {
                self.blocks.push(block);
            }
        }
        Ok(())
    }

    /// One block for each pair of parities whose product is the parity of the target.
    fn blocks_of(&self, sides: &Sides) -> Result<Vec<Block>, LimitExceeded> {
        let (left, right) = (self.by_parity(&sides.left)?, self.by_parity(&sides.right)?);
        let mut blocks = Vec::new();
        for (signs, left) in left {
            let fits =
                |(other, _): &&(ParityBits, Vec<Term>)| signs ^ other == self.rule.target_parity();
            if let Some((_, right)) = right.iter().find(fits) {
                let right = right.clone();
                blocks.push(Block { left, right });
            }
        }
        Ok(blocks)
    }

    /// Products of one term of each list by their parities, each group sorted by degree, then term.
    fn by_parity(
        &self,
        lists: &[Arc<TermList>],
    ) -> Result<Vec<(ParityBits, Vec<Term>)>, LimitExceeded> {
        let number = size(lists);
        if number > LIBRARY.listed_terms {
            return Err(LimitExceeded::List(number));
        }
        let mut groups: BTreeMap<ParityBits, Vec<(u64, Term)>> = BTreeMap::new();
        for term in products(lists) {
            if let Some(signs) = self.rule.parity_bits(&term) {
                let group = groups.entry(signs).or_default();
                group.push((degree_key(&term), term));
            }
        }
        let sorted = groups.into_iter().map(|(signs, mut group)| {
            group.sort_unstable();
            (signs, group.into_iter().map(|(_, term)| term).collect())
        });
        Ok(sorted.collect())
    }

    /// Makes the listed terms the first block. Returns by how many places the other blocks move.
    fn put_listed_first(&mut self) -> usize {
        if self.listed.is_empty() {
            return 0;
        }
        let mut listed = std::mem::take(&mut self.listed);
        listed.sort_unstable();
        listed.sort_by_cached_key(degree_key);
        self.blocks.insert(0, Block::listed(listed));
        1
    }

    /// Slots in a product's blocks whose terms are in another product too.
    fn slots_of(
        &mut self,
        product: &Product,
        other: &Product,
        range: Range<usize>,
        index: &SlotIndex,
    ) -> Result<Vec<usize>, LayoutError> {
        let mut slots = Vec::new();
        let Some(common) = product.without_exclusions().intersection(other)? else {
            return Ok(slots);
        };
        let number = self.rule.size(common.factors());
        self.budget.need(number.saturating_mul(EMPTY_SLOT_BYTES))?;
        // With a bound on degrees, few products of whole lists would remain.
        if common.exclusions().is_empty() && self.rule.degrees().is_none() {
            let lists = common.factors();
            let mut blocks = range.clone();
            if blocks.all(|at| index.slots_of_product(&self.blocks, at, lists, &mut slots)) {
                return Ok(slots);
            }
            slots.clear();
        }
        for sides in self.sides(&common)? {
            for block in self.blocks_of(&sides)? {
                let gone = block.terms();
                let gone = gone.filter(|t| !common.exclusions().iter().any(|h| h.contains(t)));
                slots.extend(gone.filter_map(|t| index.find(&self.blocks, range.clone(), &t)));
            }
        }
        Ok(slots)
    }
}

/// A degree as an integer of the same order: the bits of non-negative floats ascend with them.
fn degree_key(term: &Term) -> u64 {
    term.degree().to_bits()
}

/// Two sides of similar length: the lists in their order, split at the best place, or assigned greedily, whichever is shorter.
fn balanced_split(lists: Vec<Arc<TermList>>) -> Sides {
    let total = |sides: &Sides| size(&sides.left).saturating_add(size(&sides.right));
    let at = |i: usize| {
        let (left, right) = lists.split_at(i);
        let (left, right) = (left.to_vec(), right.to_vec());
        Sides { left, right }
    };
    // The left side grows with the split, so the best is just before or where it overtakes the right one.
    let overtakes = (1..=lists.len()).find(|i| {
        let sides = at(*i);
        size(&sides.left) >= size(&sides.right)
    });
    let i = overtakes.unwrap_or(lists.len());
    let candidates = [
        at(i.saturating_sub(1).max(1).min(lists.len())),
        at(i),
        longest_first(&lists),
    ];
    let best = candidates.into_iter().min_by_key(total);
    best.unwrap_or_else(|| at(lists.len()))
}

/// Assigns each list, longest first, to the side that is shorter so far (longest processing time first, Graham 1969).
fn longest_first(lists: &[Arc<TermList>]) -> Sides {
    let mut order: Vec<usize> = (0..lists.len()).collect();
    order.sort_by_key(|i| Reverse(lists.get(*i).map_or(0, |l| l.len())));
    let (mut left, mut right) = ((1u128, Vec::new()), (1u128, Vec::new()));
    for i in order {
        let side = if left.0 <= right.0 {
            &mut left
        } else {
            &mut right
        };
        side.0 = side
            .0
            .saturating_mul(lists.get(i).map_or(1, |l| l.len() as u128));
        side.1.push(i);
    }
    let pick = |mut which: Vec<usize>| {
        which.sort_unstable();
        which
            .iter()
            .filter_map(|i| lists.get(*i).cloned())
            .collect()
    };
    Sides {
        left: pick(left.1),
        right: pick(right.1),
    }
}
