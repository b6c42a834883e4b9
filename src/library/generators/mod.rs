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
                "the {what} must be a whole number from {least} up, or a rising range such as 1..3"
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
    let mut terms: Vec<Term> = Vec::with_capacity(atoms.len());
    for atom in atoms {
        let (_, term) = atom.clone().into_term();
        if !term.is_one() && !terms.contains(&term) {
            terms.push(term);
        }
    }
    terms
}

/// `base^p` for p = 0, 1, …, cap.
fn power_table(base: &Term, cap: u32) -> Vec<Term> {
    (0..=cap).map(|p| base.pow(f64::from(p))).collect()
}
