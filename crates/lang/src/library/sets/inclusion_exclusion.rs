//! The size of a union of products by inclusion and exclusion.
//!
//! In: products. Out: the number of their distinct terms that a selection rule admits. Intersections and exclusions are products too, so
//! they are counted the same way. Makes no term.

use crate::library::sets::product::Product;
use crate::library::sets::selection_rule::SelectionRule;
use crate::thresholds::LIBRARY;

/// Inclusion and exclusion with a budget of steps.
#[derive(Default)]
pub(crate) struct Counter {
    steps: usize,
}

impl Counter {
    /// Number of terms that the rule admits, each counted once; `None` if that takes too many steps.
    pub fn count(&mut self, products: &[Product], rule: &SelectionRule) -> Option<u128> {
        let mut total: u128 = 0;
        for (i, product) in products.iter().enumerate() {
            let earlier = products.get(..i).unwrap_or_default();
            let others = earlier.iter().filter(|p| p.group != product.group);
            let whole = product.without_exclusions();
            let mut lost = Vec::new();
            for other in product.exclusions().iter().chain(others) {
                self.steps += 1;
                if self.steps > LIBRARY.intersections {
                    return None;
                }
                if let Some(overlap) = whole.intersection(other).ok()? {
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

    /// Adds a product unless one of the others contains it, and drops those that it contains. Without this, each repetition would
    /// double the number of steps.
    fn add(&mut self, products: &mut Vec<Product>, new: Product) -> Option<()> {
        self.steps += products.len();
        for old in products.iter() {
            if old.is_superset(&new).ok()? {
                return Some(());
            }
        }
        let mut kept = Vec::with_capacity(products.len() + 1);
        for old in products.drain(..) {
            if !new.is_superset(&old).ok()? {
                kept.push(old);
            }
        }
        kept.push(new);
        *products = kept;
        Some(())
    }
}
