//! `powers(atoms; p)`: the tensor power series, each atom to 0 … p independently.

use crate::library::generators::generator::{Exponents, Generator, Misuse, monomials, whole};
use crate::library::sets::combinatorics::power;
use crate::model::NumberArg;
use crate::term::{Expr, Term};

pub(crate) struct TensorPowers;

const USAGE: &str = "powers(atoms; cap)";

impl Generator for TensorPowers {
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
