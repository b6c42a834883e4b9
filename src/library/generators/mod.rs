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

/// Atoms as factors of products, sorted; their numbers go into the coefficients.
fn factors(atoms: &[Expr]) -> Vec<Term> {
    let mut terms: Vec<Term> = Vec::with_capacity(atoms.len());
    for atom in atoms {
        let (_, term) = atom.clone().into_term();
        if !term.is_one() {
            terms.push(term);
        }
    }
    terms.sort();
    terms.dedup();
    terms
}

/// `base^p` for p = 1, …, cap.
fn power_table(base: &Term, cap: u32) -> Vec<Term> {
    (1..=cap).map(|p| base.pow(f64::from(p))).collect()
}

/// All products of powers of `factors`, each up to `cap`, with their degrees; `total` limits the degree.
///
/// Built from the last factor to the first, so that the terms of plain factors come out in the order of terms: 1, then the
/// powers of the first factor with all that follows, then all without it.
fn products(factors: &[Term], cap: u32, total: Option<u32>) -> Vec<(Term, u32)> {
    let mut done = vec![(Term::one(), 0)];
    for factor in factors.iter().rev() {
        let table = power_table(factor, cap);
        let mut all = vec![(Term::one(), 0)];
        for (power, raised) in (1..).zip(&table) {
            let fitting = done
                .iter()
                .filter(|(_, degree)| total.is_none_or(|t| degree + power <= t));
            all.extend(fitting.map(|(t, degree)| (raised.mul(t), degree + power)));
        }
        all.extend(done.into_iter().skip(1));
        done = all;
    }
    done
}
