//! The generators, one file each. To add one: its file, its `mod` line, its entry in [`GENERATORS`].

mod fourier;
mod lags;
mod poly;
mod powers;

use super::{Generator, Misuse};
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
fn factors(atoms: &[Expr]) -> Vec<Term> {
    let mut terms: Vec<Term> = atoms.iter().map(|a| a.clone().into_term().1).collect();
    terms.retain(|t| !t.is_one());
    terms.sort_unstable();
    terms.dedup();
    terms
}

/// Every product of powers of the atoms with each exponent up to `each` and their sum in `total`, in the order of terms, so
/// that sorting them costs nothing.
fn monomials(atoms: &[Expr], each: u32, total: (u32, u32)) -> Vec<Term> {
    let powers: Vec<Vec<Term>> = factors(atoms)
        .iter()
        .map(|f| {
            (1..=each.min(total.1))
                .map(|p| f.pow(f64::from(p)))
                .collect()
        })
        .collect();
    let mut out = Vec::new();
    extend(&mut out, Term::one(), 0, &powers, total);
    out
}

/// `prefix`, and its products with the powers of the factors that are left. As deep as a product has factors, which the limit
/// on the number of terms keeps small.
fn extend(out: &mut Vec<Term>, prefix: Term, degree: u32, powers: &[Vec<Term>], total: (u32, u32)) {
    let room = (total.1 - degree) as usize;
    let at = (degree >= total.0).then_some(out.len());
    if at.is_some() {
        out.push(Term::one());
    }
    for (i, of_one) in powers.iter().enumerate() {
        let after = powers.get(i + 1..).unwrap_or(&[]);
        for (p, power) in (degree + 1..).zip(of_one.iter().take(room)) {
            extend(out, prefix.mul(power), p, after, total);
        }
    }
    if let Some(place) = at.and_then(|i| out.get_mut(i)) {
        *place = prefix;
    }
}
