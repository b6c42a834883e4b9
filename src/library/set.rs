//! Sets of terms as unions of products, and their algebra: nothing is multiplied out that need not be.
//!
//! In: lists and products. Out: sets that answer how many terms they have and whether they have a given one.

use std::sync::Arc;

use super::count::Counter;
use super::list::{List, Unwieldy, size};
use super::product::Product;
use super::rule::Rule;
use super::{MAX_LIST, MAX_PRODUCTS};
use crate::term::{Atom, Term};

/// Sets up to this size are listed: Φ of a thousand columns costs little to store, and they read in order of degree. Tests take
/// the ways of large sets with small ones.
pub(super) const LISTED: u128 = if cfg!(test) { 12 } else { 1_000 };

/// A union of products. Those of one group have no term in common, those of different groups may.
#[derive(Clone, Debug, Default)]
pub(super) struct Set {
    products: Vec<Product>,
}

impl Set {
    pub fn of(terms: Vec<Term>) -> Set {
        Set::of_products(vec![Product::of(List::new(terms))])
    }

    /// Products without a term in common.
    pub fn of_products(mut products: Vec<Product>) -> Set {
        products.retain(|p| p.size() > 0);
        Set { products }
    }

    pub fn products(&self) -> &[Product] {
        &self.products
    }

    pub fn contains(&self, term: &Term) -> bool {
        self.products.iter().any(|p| p.contains(term))
    }

    /// Number of terms, each counted once; `None` where too many products overlap for that.
    pub fn count(&self, rule: &Rule) -> Option<u128> {
        Counter::default().count(&self.products, rule)
    }

    /// Terms counted as often as products have them, holes too: a bound.
    pub fn bound(&self) -> u128 {
        let sizes = self.products.iter().map(Product::size);
        sizes.fold(0, u128::saturating_add)
    }

    /// All terms, sorted.
    ///
    /// # Errors
    /// More than a list may have.
    pub fn list(&self) -> Result<Arc<List>, Unwieldy> {
        let bound = self.bound();
        if bound > MAX_LIST {
            return Err(Unwieldy::List(bound));
        }
        if let [one] = self.products.as_slice() {
            return one.list();
        }
        let mut terms = Vec::new();
        for product in &self.products {
            terms.extend_from_slice(product.list()?.terms());
        }
        Ok(List::new(terms))
    }

    /// The only term, if there is but one.
    pub fn single(&self) -> Option<Term> {
        if self.bound() > MAX_LIST {
            return None;
        }
        match self.list().ok()?.terms() {
            [one] => Some(one.clone()),
            _ => None,
        }
    }

    pub fn union(sets: impl IntoIterator<Item = Set>) -> Result<Set, Unwieldy> {
        let mut products = Vec::new();
        let mut groups = 0;
        for set in sets {
            let first = groups;
            for mut product in set.products {
                product.group += first;
                groups = groups.max(product.group + 1);
                products.push(product);
            }
        }
        Set { products }.joined(groups)
    }

    /// Small sets and single lists as one list, in a group of its own.
    fn joined(mut self, group: usize) -> Result<Set, Unwieldy> {
        let whole = self.bound() <= LISTED;
        let is_plain = |p: &Product| whole || (p.factors().len() < 2 && p.holes().is_empty());
        let (plain, mut products): (Vec<_>, Vec<_>) = self.products.drain(..).partition(is_plain);
        let mut plain = Set { products: plain };
        if plain.products.len() > 1 && plain.bound() <= MAX_LIST {
            plain.products = vec![Product::of(plain.list()?).in_group(group)];
        }
        products.append(&mut plain.products);
        limited(products)
    }

    /// Every product of a term here with one there.
    ///
    /// # Errors
    /// Lists that share atoms and are too long together; too many products.
    pub fn times(&self, other: &Set) -> Result<Set, Unwieldy> {
        let number = self.products.len().saturating_mul(other.products.len());
        if number > MAX_PRODUCTS {
            return Err(Unwieldy::Products);
        }
        let apart = number == 1 || self.is_apart(other);
        let groups = 1 + other.products.iter().map(|p| p.group).max().unwrap_or(0);
        let mut products = Vec::with_capacity(number);
        for a in &self.products {
            for b in &other.products {
                let group = match apart {
                    true => a.group * groups + b.group,
                    false => products.len(),
                };
                products.push(a.times(b)?.in_group(group));
            }
        }
        let made = Set::of_products(products);
        if apart { Ok(made) } else { made.joined(number) }
    }

    fn is_apart(&self, other: &Set) -> bool {
        let mut mine: Vec<&Atom> = self.atoms().collect();
        mine.sort_unstable();
        other.atoms().all(|atom| mine.binary_search(&atom).is_err())
    }

    fn atoms(&self) -> impl Iterator<Item = &Atom> {
        let lists = self.products.iter().flat_map(Product::factors);
        lists.flat_map(|list| list.atoms())
    }

    /// Every term times one.
    pub fn shifted(&self, by: &Term) -> Set {
        let shifted = self.products.iter();
        Set::of_products(shifted.map(|p| p.shifted(by).in_group(p.group)).collect())
    }

    /// The terms that are not in the other set, and whether any was.
    pub fn minus(&self, other: &Set) -> Result<(Set, bool), Unwieldy> {
        let mut common = Vec::new();
        let mut left = Vec::with_capacity(self.products.len());
        'products: for product in &self.products {
            let mut holes = Vec::new();
            for gone in &other.products {
                let overlap = product.and(gone)?;
                holes.extend(overlap.is_some().then(|| gone.clone()));
                common.extend(overlap);
                if gone.covers(product)? {
                    continue 'products;
                }
            }
            let kept = match product.factors() {
                [one] => Product::of(one.filtered(|t| !holes.iter().any(|h| h.contains(t))))
                    .with_holes(product.holes().iter().cloned()),
                _ => product.clone().with_holes(holes),
            };
            left.push(kept.in_group(product.group));
        }
        // Overlaps of holes alone are none: those are counted out.
        let groups = common.into_iter().zip(0..);
        let products = groups.map(|(p, group)| p.in_group(group)).collect();
        let any = Set { products }.count(&Rule::none()) != Some(0);
        let left = Set::of_products(left);
        // What is left of a small set is small.
        let groups = 1 + left.products.iter().map(|p| p.group).max().unwrap_or(0);
        Ok((left.joined(groups)?, any))
    }

    /// Without one term; unchanged if it is not there.
    pub fn without(mut self, term: &Term) -> Set {
        for product in self.products.iter_mut().filter(|p| p.contains(term)) {
            let hole = Product::of(List::new(vec![term.clone()]));
            *product = std::mem::take(product).with_holes([hole]);
        }
        self
    }
}

fn limited(products: Vec<Product>) -> Result<Set, Unwieldy> {
    if products.len() > MAX_PRODUCTS {
        return Err(Unwieldy::Products);
    }
    Ok(Set::of_products(products))
}

/// Every product of one term of each list; the lists must have no atoms in common.
pub(super) fn product_of(lists: Vec<Arc<List>>) -> Result<Set, Unwieldy> {
    match size(&lists) {
        0 => Ok(Set::default()),
        _ => Ok(Set::of_products(vec![Product::from_factors(lists)])),
    }
}
