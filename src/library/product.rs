//! A product of lists without common atoms, less some other products: the form in which sets of terms are kept.
//!
//! A term falls in one way only into parts over such lists, so that all products are distinct, their number is a product of
//! lengths, and membership is a look into each list. Multiplies lists out only where they share atoms.

use std::sync::Arc;

use super::MAX_LIST;
use super::list::{List, Unwieldy, components, multiply_out, size};
use crate::term::Term;

/// Every product of one term of each factor that is in none of the holes.
#[derive(Clone, Debug, Default)]
pub(super) struct Product {
    /// No two have an atom in common, none is the list of 1 alone. None at all is the set of 1.
    factors: Vec<Arc<List>>,
    /// What is left out. Holes may reach beyond the product, and have holes themselves.
    holes: Vec<Product>,
    /// Products of one set and one group have no term in common.
    pub group: usize,
}

/// Most terms that the overlap of two products may be searched among.
const MAX_SEARCH: u128 = 2_000_000;
/// Sums of fractional exponents differ by less.
const ROUNDING: f64 = 1e-6;

impl Product {
    pub fn of(list: Arc<List>) -> Product {
        Product::from_factors(vec![list])
    }

    /// The factors must not share atoms.
    pub fn from_factors(mut factors: Vec<Arc<List>>) -> Product {
        factors.retain(|list| list.len() != 1 || !list.atoms().is_empty());
        Product {
            factors,
            ..Product::default()
        }
    }

    pub fn factors(&self) -> &[Arc<List>] {
        &self.factors
    }

    pub fn holes(&self) -> &[Product] {
        &self.holes
    }

    pub fn with_holes(mut self, holes: impl IntoIterator<Item = Product>) -> Product {
        self.holes.extend(holes);
        self
    }

    pub fn in_group(self, group: usize) -> Product {
        Product { group, ..self }
    }

    pub fn without_holes(&self) -> Product {
        Product::from_factors(self.factors.clone())
    }

    /// Number of products, holes not taken off; `u128::MAX` if it does not fit.
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
        inside && placed == term.factors().len() && !self.holes.iter().any(|h| h.contains(term))
    }

    /// One list of everything.
    pub fn list(&self) -> Result<Arc<List>, Unwieldy> {
        let all = multiply_out(&self.factors)?;
        if self.holes.is_empty() {
            return Ok(all);
        }
        Ok(all.filtered(|t| !self.holes.iter().any(|h| h.contains(t))))
    }

    /// True if no term of one can share an atom with a term of the other.
    fn is_apart(&self, other: &Product) -> bool {
        let all = self.factors.iter().chain(&other.factors);
        components(all).len() == self.factors.len() + other.factors.len()
    }

    /// Every product of a term here with one there.
    ///
    /// # Errors
    /// Lists that share atoms and are too long together.
    pub fn times(&self, other: &Product) -> Result<Product, Unwieldy> {
        if self.is_apart(other) {
            return self.times_apart(other);
        }
        if !self.holes.is_empty() || !other.holes.is_empty() {
            return Product::of(self.list()?).times(&Product::of(other.list()?));
        }
        let all: Vec<Arc<List>> = self.factors.iter().chain(&other.factors).cloned().collect();
        let merged = components(all.iter()).into_iter().map(|members| {
            let members: Vec<Arc<List>> = pick(&all, &members);
            multiply_out(&members)
        });
        Ok(Product::from_factors(merged.collect::<Result<_, _>>()?))
    }

    fn times_apart(&self, other: &Product) -> Result<Product, Unwieldy> {
        let factors = self.factors.iter().chain(&other.factors).cloned();
        let mut holes = Vec::new();
        for (with_holes, whole) in [(self, other), (other, self)] {
            for hole in &with_holes.holes {
                // Within its own product, so that it too has no atom in common with the other.
                if let Some(inside) = with_holes.without_holes().and(hole)? {
                    holes.push(inside.times_apart(&whole.without_holes())?);
                }
            }
        }
        Ok(Product::from_factors(factors.collect()).with_holes(holes))
    }

    /// Every term times one.
    pub fn shifted(&self, by: &Term) -> Product {
        let mut left = by.clone();
        let mut factors: Vec<Arc<List>> = Vec::with_capacity(self.factors.len() + 1);
        for list in &self.factors {
            let part = list.part(by);
            factors.push(match part.is_one() {
                true => list.clone(),
                false => list.times(&part),
            });
            left = left.part(|atom| !list.has_atom(atom));
        }
        factors.push(List::new(vec![left]));
        Product::from_factors(factors).with_holes(self.holes.iter().map(|h| h.shifted(by)))
    }

    /// True if every term of the other is seen to be here.
    ///
    /// # Errors
    /// As for [`Product::and`].
    pub fn covers(&self, other: &Product) -> Result<bool, Unwieldy> {
        let common = match self.holes.is_empty() {
            true => other.without_holes().and(self)?,
            false => None,
        };
        Ok(common.is_some_and(|c| c.size() == other.size()))
    }

    /// What both have in common; `None` if nothing, as far as that is seen without counting holes.
    ///
    /// # Errors
    /// Lists that share atoms and whose common terms would have to be searched among too many.
    pub fn and(&self, other: &Product) -> Result<Option<Product>, Unwieldy> {
        let all: Vec<Arc<List>> = self.factors.iter().chain(&other.factors).cloned().collect();
        let mut common = Vec::new();
        for members in components(all.iter()) {
            let split = members.partition_point(|i| *i < self.factors.len());
            let (mine, theirs) = members.split_at(split);
            let Some(list) = common_list(&pick(&all, mine), &pick(&all, theirs))? else {
                return Ok(None);
            };
            common.push(list);
        }
        let holes = self.holes.iter().chain(&other.holes).cloned();
        Ok(Some(Product::from_factors(common).with_holes(holes)))
    }
}

fn pick(lists: &[Arc<List>], which: &[usize]) -> Vec<Arc<List>> {
    let picked = which.iter().filter_map(|i| lists.get(*i));
    picked.cloned().collect()
}

/// Terms that are products over both; `None` if there are none.
fn common_list(mine: &[Arc<List>], theirs: &[Arc<List>]) -> Result<Option<Arc<List>>, Unwieldy> {
    if let ([a], [b]) = (mine, theirs)
        && Arc::ptr_eq(a, b)
    {
        return Ok(Some(a.clone()));
    }
    let ((a0, a1), (b0, b1)) = (degrees(mine), degrees(theirs));
    if a1 + ROUNDING < b0 || b1 + ROUNDING < a0 {
        return Ok(None);
    }
    let (few, many) = match size(mine) <= size(theirs) {
        true => (mine, theirs),
        false => (theirs, mine),
    };
    if size(few) > MAX_SEARCH {
        return Err(Unwieldy::List(size(few)));
    }
    let many = Product::from_factors(many.to_vec());
    let mut terms = Vec::new();
    search(few, &Term::one(), &many, &mut terms);
    if terms.len() as u128 > MAX_LIST {
        return Err(Unwieldy::List(terms.len() as u128));
    }
    Ok((!terms.is_empty()).then(|| List::new(terms)))
}

/// The products over `lists` that `within` has too. As deep as a product has lists.
fn search(lists: &[Arc<List>], prefix: &Term, within: &Product, found: &mut Vec<Term>) {
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
fn degrees(lists: &[Arc<List>]) -> (f64, f64) {
    lists.iter().fold((0.0, 0.0), |(least, largest), list| {
        let (a, b) = list.degrees();
        (least + a, largest + b)
    })
}
