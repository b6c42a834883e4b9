//! What a generator is, and what all of them share: reading their numbers, multiplying their atoms.
//!
//! In: atoms and numbers as written. Out: checked numbers, monomials one by one. Knows no generator by name.

use crate::model::NumberArg;
use crate::source::Span;
use crate::term::{Expr, Term};
use crate::thresholds::LIBRARY;

/// A family of terms made from atoms and numbers: one file and one line in [`super::GENERATORS`].
pub trait Generator: Sync {
    fn name(&self) -> &'static str;
    /// How it is written, e.g. `poly(atoms; degree)`.
    fn usage(&self) -> &'static str;
    /// One line for listings.
    fn about(&self) -> &'static str;
    /// True if its terms exist only in discrete time.
    fn discrete_only(&self) -> bool {
        false
    }
    /// True if its atoms are angles, which have no unit.
    fn of_angles(&self) -> bool {
        false
    }
    /// Number of terms for this many atoms, by arithmetic; also checks the numbers.
    fn count(&self, atoms: usize, numbers: &[NumberArg]) -> Result<u128, Misuse>;
    /// The exponents, for a generator of monomials. Its terms are then kept as products of the powers of each atom, and there may
    /// be millions. The terms of other generators are listed.
    fn exponents(&self, _numbers: &[NumberArg]) -> Result<Option<Exponents>, Misuse> {
        Ok(None)
    }
    /// The terms, one by one. Called only after [`Generator::count`] accepted the numbers and gave few enough terms.
    fn expand(&self, atoms: &[Expr], numbers: &[NumberArg]) -> Result<Vec<Term>, Misuse>;
}

/// The exponents of monomials: each atom's from 0 to `each`, their sum within `total`, ends included.
#[derive(Clone, Copy, Debug)]
pub struct Exponents {
    pub each: u32,
    pub total: (u32, u32),
}

impl Exponents {
    /// Every exponent up to a cap, independently.
    pub fn each(cap: u32) -> Exponents {
        Exponents {
            each: cap,
            total: (0, u32::MAX),
        }
    }

    pub(crate) fn is_bounded(self) -> bool {
        self.total.1 != u32::MAX
    }
}

/// A wrong use of a generator: the message, the place if one number is wrong, and how to write it.
#[derive(Clone, Debug)]
pub struct Misuse {
    pub message: String,
    pub at: Option<Span>,
    pub help: String,
}

/// The one number of a generator as a range of integers: `a..b` as written, a single `b` as `least..b`.
pub(crate) fn whole_range(
    numbers: &[NumberArg],
    what: &str,
    least: u32,
    usage: &str,
) -> Result<(u32, u32), Misuse> {
    let [n] = numbers else {
        return Err(Misuse {
            message: format!(
                "this needs one number after `;`: the {what}; it has {}",
                numbers.len()
            ),
            at: None,
            help: format!("write {usage}"),
        });
    };
    let whole = |x: f64| x.fract() == 0.0 && x >= f64::from(least) && x <= LIBRARY.generator_number;
    if !whole(n.from) || !whole(n.to) || n.from > n.to {
        return Err(Misuse {
            message: format!(
                "the {what} must be a whole number from {least} to {}, or a rising range such as 1..3",
                LIBRARY.generator_number
            ),
            at: Some(n.span),
            help: format!("write {usage}"),
        });
    }
    let from = if n.range { n.from as u32 } else { least };
    Ok((from, n.to as u32))
}

/// The one number of a generator that takes no range.
pub(crate) fn whole(
    numbers: &[NumberArg],
    what: &str,
    least: u32,
    usage: &str,
) -> Result<u32, Misuse> {
    let (_, to) = whole_range(numbers, what, least, usage)?;
    match numbers {
        [n] if n.range => Err(Misuse {
            message: format!("the {what} must be one number, not a range"),
            at: Some(n.span),
            help: format!("write {usage}"),
        }),
        _ => Ok(to),
    }
}

/// Atoms as factors of products, distinct and sorted; their numeric factors go into the coefficients.
pub(crate) fn factors(atoms: &[Expr]) -> Vec<Term> {
    let mut terms: Vec<Term> = atoms.iter().map(|a| a.clone().into_term().1).collect();
    terms.retain(|t| !t.is_one());
    terms.sort_unstable();
    terms.dedup();
    terms
}

/// The monomials of atoms, as a list.
pub(crate) fn monomials(atoms: &[Expr], exponents: Exponents) -> Vec<Term> {
    let (least, most) = exponents.total;
    let mut all = vec![(0, Term::one())];
    for factor in factors(atoms) {
        let powers: Vec<Term> = (0..=exponents.each.min(most))
            .map(|p| factor.pow(f64::from(p)))
            .collect();
        let mut next = Vec::new();
        for (degree, term) in &all {
            let steps = (*degree..=most).zip(&powers);
            next.extend(steps.map(|(sum, power)| (sum, term.mul(power))));
        }
        all = next;
    }
    all.retain(|(degree, _)| *degree >= least);
    all.into_iter().map(|(_, t)| t).collect()
}
