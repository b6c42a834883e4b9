//! Products of coprime lists (no two share an atom), without some other products: the form in which sets of terms are kept.
//!
//! In: lists. Out: products with size, membership, intersection. A term factors over coprime lists in one way only. So all products
//! are distinct, their number is the product of lengths, and membership is one look-up in each list. Multiplies lists out only where
//! they share atoms.

use std::sync::Arc;

use crate::library::sets::term_list::{LimitExceeded, TermList, components, multiply_out, size};
use crate::term::Term;
use crate::thresholds::LIBRARY;

/// Every product of one term of each factor that is in none of the excluded products.
#[derive(Clone, Debug, Default)]
pub(crate) struct Product {
    /// Coprime; none is the list of 1 alone. Without factors this is the set of 1.
    factors: Vec<Arc<TermList>>,
    /// What is left out. Excluded products may reach beyond this one, and have exclusions themselves.
    exclusions: Vec<Product>,
    /// Products of one set with the same group are disjoint.
    pub group: usize,
}

/// Equal sums of fractional exponents differ by less than this after rounding.
const DEGREE_ROUNDING: f64 = 1e-6;

impl Product {
    pub fn of(list: Arc<TermList>) -> Product {
        Product::from_factors(vec![list])
    }

    /// The factors must be coprime.
    pub fn from_factors(mut factors: Vec<Arc<TermList>>) -> Product {
        factors.retain(|list| list.len() != 1 || !list.atoms().is_empty());
        Product {
            factors,
            ..Product::default()
        }
    }

    pub fn factors(&self) -> &[Arc<TermList>] {
        &self.factors
    }

    pub fn exclusions(&self) -> &[Product] {
        &self.exclusions
    }

    pub fn excluding(mut self, exclusions: impl IntoIterator<Item = Product>) -> Product {
        self.exclusions.extend(exclusions);
        self
    }

    pub fn in_group(self, group: usize) -> Product {
        Product { group, ..self }
    }

    pub fn without_exclusions(&self) -> Product {
        Product::from_factors(self.factors.clone())
    }

    /// Number of products, excluded ones included; `u128::MAX` if it does not fit.
    pub fn size(&self) -> u128 {
        size(&self.factors)
    }

    pub fn contains(&self, term: &Term) -> bool {
        let mut placed = 0;
        let inside = self.factors.iter().all(|list| {
            let part = list.part(term);
            placed += part.factors().len();
            list.contains(&part)
        });
        inside
            && placed == term.factors().len()
            && !self.exclusions.iter().any(|h| h.contains(term))
    }

    /// All terms as one list.
    ///
    /// # Errors
    /// More terms than a list may have.
    pub fn list(&self) -> Result<Arc<TermList>, LimitExceeded> {
        let all = multiply_out(&self.factors)?;
        if self.exclusions.is_empty() {
            return Ok(all);
        }
        Ok(all.filtered(|t| !self.exclusions.iter().any(|h| h.contains(t))))
    }

    /// True if no factor of one shares an atom with a factor of the other.
    fn is_coprime(&self, other: &Product) -> bool {
        let all = self.factors.iter().chain(&other.factors);
        components(all).len() == self.factors.len() + other.factors.len()
    }

    /// Every product of a term here with one there.
    ///
    /// # Errors
    /// Lists that share atoms and are too long together.
    pub fn times(&self, other: &Product) -> Result<Product, LimitExceeded> {
        if self.is_coprime(other) {
            return self.times_coprime(other);
        }
        if !self.exclusions.is_empty() || !other.exclusions.is_empty() {
            return Product::of(self.list()?).times(&Product::of(other.list()?));
        }
        let all: Vec<Arc<TermList>> = self.factors.iter().chain(&other.factors).cloned().collect();
        let merged = components(all.iter()).into_iter().map(|members| {
            let members: Vec<Arc<TermList>> = pick(&all, &members);
            multiply_out(&members)
        });
        Ok(Product::from_factors(merged.collect::<Result<_, _>>()?))
    }

    fn times_coprime(&self, other: &Product) -> Result<Product, LimitExceeded> {
        let factors = self.factors.iter().chain(&other.factors).cloned();
        let mut exclusions = Vec::new();
        for (excluding, whole) in [(self, other), (other, self)] {
            for exclusion in &excluding.exclusions {
                // Restricted to its own product, it is coprime with the other one too.
                if let Some(inside) = excluding.without_exclusions().intersection(exclusion)? {
                    exclusions.push(inside.times_coprime(&whole.without_exclusions())?);
                }
            }
        }
        Ok(Product::from_factors(factors.collect()).excluding(exclusions))
    }

    /// Every term multiplied by `by`.
    pub fn times_term(&self, by: &Term) -> Product {
        let mut left = by.clone();
        let mut factors: Vec<Arc<TermList>> = Vec::with_capacity(self.factors.len() + 1);
        for list in &self.factors {
            let part = list.part(by);
            factors.push(match part.is_one() {
                true => list.clone(),
                false => list.times(&part),
            });
            left = left.part(|atom| !list.has_atom(atom));
        }
        factors.push(TermList::new(vec![left]));
        Product::from_factors(factors).excluding(self.exclusions.iter().map(|h| h.times_term(by)))
    }

    /// True only if every term of the other is here. May be false even so, since exclusions are not counted.
    ///
    /// # Errors
    /// As for [`Product::intersection`].
    pub fn is_superset(&self, other: &Product) -> Result<bool, LimitExceeded> {
        let common = match self.exclusions.is_empty() {
            true => other.without_exclusions().intersection(self)?,
            false => None,
        };
        Ok(common.is_some_and(|c| c.size() == other.size()))
    }

    /// The intersection; `None` if the factors have no common term. Exclusions may still leave it empty.
    ///
    /// # Errors
    /// Lists that share atoms and have too many products to search for common terms.
    pub fn intersection(&self, other: &Product) -> Result<Option<Product>, LimitExceeded> {
        let all: Vec<Arc<TermList>> = self.factors.iter().chain(&other.factors).cloned().collect();
        let mut common = Vec::new();
        for members in components(all.iter()) {
            let split = members.partition_point(|i| *i < self.factors.len());
            let (mine, theirs) = members.split_at(split);
            let Some(list) = common_list(&pick(&all, mine), &pick(&all, theirs))? else {
                return Ok(None);
            };
            common.push(list);
        }
        let exclusions = self.exclusions.iter().chain(&other.exclusions).cloned();
        Ok(Some(Product::from_factors(common).excluding(exclusions)))
    }
}

fn pick(lists: &[Arc<TermList>], which: &[usize]) -> Vec<Arc<TermList>> {
    let picked = which.iter().filter_map(|i| lists.get(*i));
    picked.cloned().collect()
}

/// Terms that are products over both `mine` and `theirs`; `None` if there are none.
fn common_list(
    mine: &[Arc<TermList>],
    theirs: &[Arc<TermList>],
) -> Result<Option<Arc<TermList>>, LimitExceeded> {
    if let ([a], [b]) = (mine, theirs)
        && Arc::ptr_eq(a, b)
    {
        return Ok(Some(a.clone()));
    }
    let ((a0, a1), (b0, b1)) = (degrees(mine), degrees(theirs));
    if a1 + DEGREE_ROUNDING < b0 || b1 + DEGREE_ROUNDING < a0 {
        return Ok(None);
    }
    let (few, many) = match size(mine) <= size(theirs) {
        true => (mine, theirs),
        false => (theirs, mine),
    };
    if size(few) > LIBRARY.search {
        return Err(LimitExceeded::List(size(few)));
    }
    let many = Product::from_factors(many.to_vec());
    let mut terms = Vec::new();
    search(few, &Term::one(), &many, &mut terms);
    if terms.len() as u128 > LIBRARY.listed_terms {
        return Err(LimitExceeded::List(terms.len() as u128));
    }
    Ok((!terms.is_empty()).then(|| TermList::new(terms)))
}

/// Appends the products over `lists` that `within` contains. Recursion is as deep as a product has lists.
fn search(lists: &[Arc<TermList>], prefix: &Term, within: &Product, found: &mut Vec<Term>) {
    match lists.split_first() {
        None if within.contains(prefix) => found.push(prefix.clone()),
        None => {}
        Some((first, rest)) => {
            for term in first.terms() {
                search(rest, &prefix.mul(term), within, found);
            }
        }
    }
}

/// Least and largest degree of a product over lists.
fn degrees(lists: &[Arc<TermList>]) -> (f64, f64) {
    lists.iter().fold((0.0, 0.0), |(least, largest), list| {
        let (a, b) = list.degrees();
        (least + a, largest + b)
    })
}
