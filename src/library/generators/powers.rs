//! `powers(atoms; p)`: the tensor power series, each atom to 0 … p independently.

use super::{monomials, whole};
use crate::lang::model::NumberArg;
use crate::library::size::power;
use crate::library::{Exponents, Generator, Misuse};
use crate::term::{Expr, Term};

pub(super) struct Powers;

const USAGE: &str = "powers(atoms; cap)";

impl Generator for Powers {
    fn name(&self) -> &'static str {
        "powers"
    }

    fn usage(&self) -> &'static str {
        USAGE
    }

    fn about(&self) -> &'static str {
        "all products of powers 0 … p of each atom"
    }

    fn count(&self, atoms: usize, numbers: &[NumberArg]) -> Result<u128, Misuse> {
        let cap = whole(numbers, "power", 0, USAGE)?;
        Ok(power(u128::from(cap) + 1, atoms))
    }

    fn exponents(&self, numbers: &[NumberArg]) -> Result<Option<Exponents>, Misuse> {
        let each = whole(numbers, "power", 0, USAGE)?;
        Ok(Some(Exponents::each(each)))
    }

    fn expand(&self, atoms: &[Expr], numbers: &[NumberArg]) -> Result<Vec<Term>, Misuse> {
        let exponents = self.exponents(numbers)?;
        Ok(exponents.map_or_else(Vec::new, |e| monomials(atoms, e)))
    }
}
