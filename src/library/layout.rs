//! A set of terms → the blocks of a library: balanced, pruned, without a term twice.
//!
//! In: a set, the rule of its equation, a limit on memory. Out: a [`Library`]. Sizes are known by arithmetic before anything
//! is made; what the rule excludes is never made at all.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::MAX_LIST;
use super::graded::{Graded, pieces};
use super::index::Index;
use super::list::{List, Unwieldy, products, size};
use super::product::Product;
use super::rule::{Rule, Signs};
use super::set::{LISTED, Set};
use super::terms::{Block, Library};
use crate::term::Term;

/// What stands against a library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refused {
    /// Its terms, and the bytes that they need.
    Memory(u128, u128),
    Unwieldy(Unwieldy),
}

impl From<Unwieldy> for Refused {
    fn from(why: Unwieldy) -> Self {
        Refused::Unwieldy(why)
    }
}

/// Bytes of a slot: the norm of its column.
pub(super) const SLOT_BYTES: u128 = 8;
/// Bytes of a term in a list, with its factors.
const TERM_BYTES: u128 = 160;
/// A block of fewer slots costs more to call than its columns to store.
const SMALL_BLOCK: usize = if cfg!(test) { 6 } else { 256 };

/// The lists whose products make the two sides of blocks.
struct Sides {
    left: Vec<Arc<List>>,
    right: Vec<Arc<List>>,
}

/// Blocks in the making.
struct Layout<'a> {
    rule: &'a Rule,
    budget: Budget,
    /// Blocks of fewer slots are listed.
    least: usize,
    listed: Vec<Term>,
    blocks: Vec<Block>,
}

/// Bytes needed so far, and how many there are.
struct Budget {
    slots: u128,
    bytes: u128,
    limit: u128,
}

impl Budget {
    fn need(&mut self, bytes: u128) -> Result<(), Refused> {
        self.bytes = self.bytes.saturating_add(bytes);
        if self.bytes > self.limit || self.slots > (isize::MAX as u128) {
            return Err(Refused::Memory(self.slots, self.bytes));
        }
        Ok(())
    }
}

/// Lays a set out. A small one becomes one list, in order of degree.
///
/// # Errors
/// More memory than the limit, in bytes; a set that falls into too many products.
pub(super) fn lay_out(set: &Set, rule: &Rule, memory: u64) -> Result<Library, Refused> {
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
        least: match slots <= LISTED {
            true => usize::MAX,
            false => SMALL_BLOCK,
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
        for other in product.holes().iter().chain(before) {
            if !range.is_empty() {
                let index = index.get_or_insert_with(|| Index::new(&layout.blocks));
                empty.extend(layout.slots_of(product, other, range.clone(), index)?);
            }
        }
    }
    empty.sort_unstable();
    empty.dedup();
    Ok(Library::new(layout.blocks, empty))
}

/// The products without terms that the rule excludes by themselves, the largest first; those inside others left out.
fn ordered(set: &Set, rule: &Rule) -> Result<Vec<Product>, Refused> {
    let mut all = Vec::with_capacity(set.products().len());
    for product in set.products() {
        let lists = product.factors().iter().map(|l| rule.definite(l)).collect();
        let kept = Product::from_factors(lists)
            .with_holes(product.holes().iter().cloned())
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
            inside = inside || larger.covers(&product)?;
        }
        if !inside {
            out.push(product);
        }
    }
    Ok(out)
}

impl Layout<'_> {
    /// Makes the blocks of a product, less what others have already: which blocks they are.
    fn place(&mut self, product: &Product, before: &[&Product]) -> Result<Range<usize>, Refused> {
        let start = self.blocks.len();
        let all = self.sides(product)?;
        for sides in &all {
            let terms = size(&sides.left).saturating_add(size(&sides.right));
            self.budget.need(terms.saturating_mul(TERM_BYTES))?;
        }
        for sides in all {
            self.add(&sides, |term| {
                !product.holes().iter().any(|h| h.contains(term))
                    && !before.iter().any(|p| p.contains(term))
            })?;
        }
        Ok(start..self.blocks.len())
    }

    /// A product as pieces within the bound on degrees, each cut in two sides.
    fn sides(&self, product: &Product) -> Result<Vec<Sides>, Unwieldy> {
        let pieces = match self.rule.degrees() {
            None => vec![product.factors().to_vec()],
            Some(range) => {
                let graded: Vec<Graded> = product.factors().iter().map(|l| Graded::of(l)).collect();
                pieces(&graded, range)?
            }
        };
        Ok(pieces.into_iter().map(cut).collect())
    }

    /// The blocks of two sides, one for each pair of signs that make the target's; small ones term by term, if `keep` keeps them.
    fn add(&mut self, sides: &Sides, keep: impl Fn(&Term) -> bool) -> Result<(), Unwieldy> {
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

    fn blocks_of(&self, sides: &Sides) -> Result<Vec<Block>, Unwieldy> {
        let (left, right) = (self.by_signs(&sides.left)?, self.by_signs(&sides.right)?);
        let mut blocks = Vec::new();
        for (signs, left) in left {
            let fits = |(other, _): &&(Signs, Vec<Term>)| signs ^ other == self.rule.wanted();
            if let Some((_, right)) = right.iter().find(fits) {
                let right = right.clone();
                blocks.push(Block { left, right });
            }
        }
        Ok(blocks)
    }

    /// Products of one term of each list, by their signs, then by degree and term.
    fn by_signs(&self, lists: &[Arc<List>]) -> Result<Vec<(Signs, Vec<Term>)>, Unwieldy> {
        let number = size(lists);
        if number > MAX_LIST {
            return Err(Unwieldy::List(number));
        }
        let mut groups: BTreeMap<Signs, Vec<(u64, Term)>> = BTreeMap::new();
        for term in products(lists) {
            if let Some(signs) = self.rule.signs(&term) {
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

    /// Makes the listed terms the first block: by how much that moves the others.
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

    /// Slots of a product's blocks whose terms another product has too.
    fn slots_of(
        &mut self,
        product: &Product,
        other: &Product,
        range: Range<usize>,
        index: &Index,
    ) -> Result<Vec<usize>, Refused> {
        let mut slots = Vec::new();
        let Some(common) = product.without_holes().and(other)? else {
            return Ok(slots);
        };
        let number = self.rule.size(common.factors());
        self.budget.need(number.saturating_mul(SLOT_BYTES))?;
        // A bound on degrees would leave few of the products of whole lists.
        if common.holes().is_empty() && self.rule.degrees().is_none() {
            let lists = common.factors();
            let mut blocks = range.clone();
            if blocks.all(|at| index.product(&self.blocks, at, lists, &mut slots)) {
                return Ok(slots);
            }
            slots.clear();
        }
        for sides in self.sides(&common)? {
            for block in self.blocks_of(&sides)? {
                let gone = block.terms();
                let gone = gone.filter(|t| !common.holes().iter().any(|h| h.contains(t)));
                slots.extend(gone.filter_map(|t| index.find(&self.blocks, range.clone(), &t)));
            }
        }
        Ok(slots)
    }
}

/// Degrees are never negative, so their bits are ordered.
fn degree_key(term: &Term) -> u64 {
    term.degree().to_bits()
}

/// Two sides of about the same length: the lists in their order, cut where that is best, or dealt out from the longest.
fn cut(lists: Vec<Arc<List>>) -> Sides {
    let total = |sides: &Sides| size(&sides.left).saturating_add(size(&sides.right));
    let at = |i: usize| {
        let (left, right) = lists.split_at(i);
        let (left, right) = (left.to_vec(), right.to_vec());
        Sides { left, right }
    };
    // Lists in order: the left side grows with the cut, so the best is where it overtakes the right one.
    let overtakes = (1..=lists.len()).find(|i| {
        let sides = at(*i);
        size(&sides.left) >= size(&sides.right)
    });
    let i = overtakes.unwrap_or(lists.len());
    let candidates = [
        at(i.saturating_sub(1).max(1).min(lists.len())),
        at(i),
        dealt(&lists),
    ];
    let best = candidates.into_iter().min_by_key(total);
    best.unwrap_or_else(|| at(lists.len()))
}

fn dealt(lists: &[Arc<List>]) -> Sides {
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
