//! `poly(atoms; d)`: all monomials of total degree up to d, 1 included; `poly(atoms; a..b)` a range of degrees.

use crate::library::generators::generator::{Exponents, Generator, Misuse, monomials, whole_range};
use crate::library::sets::combinatorics::binomial;
use crate::model::NumberArg;
use crate::term::{Expr, Term};

pub(crate) struct Polynomial;

const USAGE: &str = "poly(atoms; degree)";

impl Generator for Polynomial {
    fn name(&self) -> &'static str {
        "poly"
    }

    fn usage(&self) -> &'static str {
        USAGE
    }

    fn about(&self) -> &'static str {
        "all monomials of total degree 0 … d (or a range a..b)"
    }

    /// C(n + b, b) − C(n + a − 1, a − 1) monomials of n atoms with degree a … b.
    fn count(&self, atoms: usize, numbers: &[NumberArg]) -> Result<u128, Misuse> {
        let (from, to) = whole_range(numbers, "degree", 0, USAGE)?;
        let up_to = |d: u32| binomial(atoms as u128 + u128::from(d), u128::from(d));
        let below = if from == 0 { 0 } else { up_to(from - 1) };
        Ok(match up_to(to) {
            u128::MAX => u128::MAX,
            all => all - below,
        })
    }

    fn exponents(&self, numbers: &[NumberArg]) -> Result<Option<Exponents>, Misuse> {
        let (from, to) = whole_range(numbers, "degree", 0, USAGE)?;
        let total = (from, to);
        Ok(Some(Exponents { each: to, total }))
    }

    fn expand(&self, atoms: &[Expr], numbers: &[NumberArg]) -> Result<Vec<Term>, Misuse> {
        let exponents = self.exponents(numbers)?;
        Ok(exponents.map_or_else(Vec::new, |e| monomials(atoms, e)))
    }
}
