//! How many terms a union of products has, by arithmetic: overlaps and holes are products too, and are counted the same way.

use super::product::Product;
use super::rule::Rule;

/// Inclusion and exclusion, for as long as it takes few steps.
#[derive(Default)]
pub(super) struct Counter {
    steps: usize,
}

/// Most overlaps to look at: about a tenth of a second.
const MAX_STEPS: usize = 50_000;

impl Counter {
    /// Number of terms that the rule admits, each counted once; `None` where that takes too many steps.
    pub fn count(&mut self, products: &[Product], rule: &Rule) -> Option<u128> {
        let mut total: u128 = 0;
        for (i, product) in products.iter().enumerate() {
            let earlier = products.get(..i).unwrap_or_default();
            let others = earlier.iter().filter(|p| p.group != product.group);
            let whole = product.without_holes();
            let mut lost = Vec::new();
            for other in product.holes().iter().chain(others) {
                self.steps += 1;
                if self.steps > MAX_STEPS {
                    return None;
                }
                if let Some(overlap) = whole.and(other).ok()? {
                    self.add(&mut lost, overlap)?;
                }
            }
            let lost: Vec<Product> = lost
                .into_iter()
                .zip(0..)
                .map(|(p, i)| p.in_group(i))
                .collect();
            let lost = if lost.is_empty() {
                0
            } else {
                self.count(&lost, rule)?
            };
            total = total.saturating_add(rule.size(product.factors()).saturating_sub(lost));
        }
        Some(total)
    }

    /// Keeps the largest of products within each other: without this, each repetition would double the steps.
    fn add(&mut self, products: &mut Vec<Product>, new: Product) -> Option<()> {
        self.steps += products.len();
        for old in products.iter() {
            if old.covers(&new).ok()? {
                return Some(());
            }
        }
        let mut kept = Vec::with_capacity(products.len() + 1);
        for old in products.drain(..) {
            if !new.covers(&old).ok()? {
                kept.push(old);
            }
        }
        kept.push(new);
        *products = kept;
        Some(())
    }
}
