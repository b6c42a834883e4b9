//! Sets of terms as unions of products, and their algebra: union, difference, product.
//!
//! In: lists and products. Out: sets that know their size and their members. Multiplies nothing out without need.

use std::sync::Arc;

use crate::library::sets::inclusion_exclusion::Counter;
use crate::library::sets::product::Product;
use crate::library::sets::selection_rule::SelectionRule;
use crate::library::sets::term_list::{LimitExceeded, TermList, size};
use crate::term::{Atom, Term};
use crate::thresholds::LIBRARY;

/// A union of products. Products of one group are disjoint, those of different groups may overlap.
#[derive(Clone, Debug, Default)]
pub(crate) struct TermSet {
    products: Vec<Product>,
}

impl TermSet {
    pub fn of(terms: Vec<Term>) -> TermSet {
        TermSet::of_products(vec![Product::of(TermList::new(terms))])
    }

    /// Disjoint products, or products with their groups set.
    pub fn of_products(mut products: Vec<Product>) -> TermSet {
        products.retain(|p| p.size() > 0);
        TermSet { products }
    }

    pub fn products(&self) -> &[Product] {
        &self.products
    }

    pub fn contains(&self, term: &Term) -> bool {
        self.products.iter().any(|p| p.contains(term))
    }

    /// Number of distinct terms that the rule admits; `None` if too many products overlap.
    pub fn count(&self, rule: &SelectionRule) -> Option<u128> {
        Counter::default().count(&self.products, rule)
    }

    /// The sum of the sizes of the products: an upper bound on the number of terms.
    pub fn upper_bound(&self) -> u128 {
        let sizes = self.products.iter().map(Product::size);
        sizes.fold(0, u128::saturating_add)
    }

    /// All terms, sorted.
    ///
    /// # Errors
    /// More than a list may have.
    pub fn list(&self) -> Result<Arc<TermList>, LimitExceeded> {
        let bound = self.upper_bound();
        if bound > LIBRARY.listed_terms {
            return Err(LimitExceeded::List(bound));
        }
        if let [one] = self.products.as_slice() {
            return one.list();
        }
        let mut terms = Vec::new();
        for product in &self.products {
            terms.extend_from_slice(product.list()?.terms());
        }
        Ok(TermList::new(terms))
    }

    /// The term of a set that has only one.
    pub fn single(&self) -> Option<Term> {
        if self.upper_bound() > LIBRARY.listed_terms {
            return None;
        }
        match self.list().ok()?.terms() {
            [one] => Some(one.clone()),
            _ => None,
        }
    }

    pub fn union(sets: impl IntoIterator<Item = TermSet>) -> Result<TermSet, LimitExceeded> {
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
        TermSet { products }.merge_small(groups)
    }

    /// Merges small sets and single lists into one list, in a group of its own.
    fn merge_small(mut self, group: usize) -> Result<TermSet, LimitExceeded> {
        let whole = self.upper_bound() <= LIBRARY.small_set;
        let is_plain = |p: &Product| whole || (p.factors().len() < 2 && p.exclusions().is_empty());
        let (plain, mut products): (Vec<_>, Vec<_>) = self.products.drain(..).partition(is_plain);
        let mut plain = TermSet { products: plain };
        if plain.products.len() > 1 && plain.upper_bound() <= LIBRARY.listed_terms {
            plain.products = vec![Product::of(plain.list()?).in_group(group)];
        }
        products.append(&mut plain.products);
        limited(products)
    }

    /// Every product of a term here with one of the other set.
    ///
    /// # Errors
    /// Lists that share atoms and are too long when multiplied out; too many products.
    pub fn times(&self, other: &TermSet) -> Result<TermSet, LimitExceeded> {
        let number = self.products.len().saturating_mul(other.products.len());
        if number > LIBRARY.products {
            return Err(LimitExceeded::Products);
        }
        let apart = number == 1 || self.is_coprime(other);
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
        let made = TermSet::of_products(products);
        if apart {
            Ok(made)
        } else {
            made.merge_small(number)
        }
    }

    fn is_coprime(&self, other: &TermSet) -> bool {
        let mut mine: Vec<&Atom> = self.atoms().collect();
        mine.sort_unstable();
        other.atoms().all(|atom| mine.binary_search(&atom).is_err())
    }

    fn atoms(&self) -> impl Iterator<Item = &Atom> {
        let lists = self.products.iter().flat_map(Product::factors);
        lists.flat_map(|list| list.atoms())
    }

    /// Every term multiplied by `by`.
    pub fn times_term(&self, by: &Term) -> TermSet {
        let times_term = self.products.iter();
        TermSet::of_products(
            times_term
                .map(|p| p.times_term(by).in_group(p.group))
                .collect(),
        )
    }

    /// The terms that are not in the other set, and whether any was removed.
    pub fn difference(&self, other: &TermSet) -> Result<(TermSet, bool), LimitExceeded> {
        let mut common = Vec::new();
        let mut left = Vec::with_capacity(self.products.len());
        'products: for product in &self.products {
            let mut exclusions = Vec::new();
            for gone in &other.products {
                let overlap = product.intersection(gone)?;
                exclusions.extend(overlap.is_some().then(|| gone.clone()));
                common.extend(overlap);
                if gone.is_superset(product)? {
                    continue 'products;
                }
            }
            let kept = match product.factors() {
                [one] => Product::of(one.filtered(|t| !exclusions.iter().any(|h| h.contains(t))))
                    .excluding(product.exclusions().iter().cloned()),
                _ => product.clone().excluding(exclusions),
            };
            left.push(kept.in_group(product.group));
        }
        // Intersections may consist of excluded terms only, so the terms are counted.
        let groups = common.into_iter().zip(0..);
        let products = groups.map(|(p, group)| p.in_group(group)).collect();
        let any = TermSet { products }.count(&SelectionRule::none()) != Some(0);
        let left = TermSet::of_products(left);
        // What is left of a small set is small.
        let groups = 1 + left.products.iter().map(|p| p.group).max().unwrap_or(0);
        Ok((left.merge_small(groups)?, any))
    }

    /// The set without one term; unchanged if the term is not in it.
    pub fn without(mut self, term: &Term) -> TermSet {
        for product in self.products.iter_mut().filter(|p| p.contains(term)) {
            let exclusion = Product::of(TermList::new(vec![term.clone()]));
            *product = std::mem::take(product).excluding([exclusion]);
        }
        self
    }
}

fn limited(products: Vec<Product>) -> Result<TermSet, LimitExceeded> {
    if products.len() > LIBRARY.products {
        return Err(LimitExceeded::Products);
    }
    Ok(TermSet::of_products(products))
}

/// Every product of one term of each list; the lists must be coprime.
pub(crate) fn product_of(lists: Vec<Arc<TermList>>) -> Result<TermSet, LimitExceeded> {
    match size(&lists) {
        0 => Ok(TermSet::default()),
        _ => Ok(TermSet::of_products(vec![Product::from_factors(lists)])),
    }
}
