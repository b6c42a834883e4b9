//! The generators, one file each. To add one: its file, its `mod` line, its entry in [`GENERATORS`].

mod fourier;
mod lags;
mod poly;
mod powers;

use super::{Exponents, Generator, Misuse};
use crate::lang::model::NumberArg;
use crate::term::{Expr, Term};

/// Every generator; the language, `sidc list` and "did you mean" read this.
pub static GENERATORS: &[&dyn Generator] =
    &[&poly::Poly, &powers::Powers, &fourier::Fourier, &lags::Lags];

/// Most that a whole number in a generator may be: far beyond any use, far below overflow.
const LARGEST: f64 = 1e6;

/// The only number of a generator as a range of whole numbers: `a..b` as written, a lone `b` as least..b.
fn whole_range(
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
    let whole = |x: f64| x.fract() == 0.0 && x >= f64::from(least) && x <= LARGEST;
    if !whole(n.from) || !whole(n.to) || n.from > n.to {
        return Err(Misuse {
            message: format!(
                "the {what} must be a whole number from {least} to {LARGEST}, or a rising range such as 1..3"
            ),
            at: Some(n.span),
            help: format!("write {usage}"),
        });
    }
    let from = if n.range { n.from as u32 } else { least };
    Ok((from, n.to as u32))
}

/// The same, where a range makes no sense.
fn whole(numbers: &[NumberArg], what: &str, least: u32, usage: &str) -> Result<u32, Misuse> {
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

/// Atoms as factors of products; their numbers go into the coefficients.
pub(super) fn factors(atoms: &[Expr]) -> Vec<Term> {
    let mut terms: Vec<Term> = atoms.iter().map(|a| a.clone().into_term().1).collect();
    terms.retain(|t| !t.is_one());
    terms.sort_unstable();
    terms.dedup();
    terms
}

/// The monomials of atoms one by one.
fn monomials(atoms: &[Expr], exponents: Exponents) -> Vec<Term> {
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
