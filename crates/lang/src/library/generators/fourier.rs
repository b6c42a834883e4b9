//! `fourier(atom; n)`: sin k·atom and cos k·atom for k = 1 … n, without the constant.

use crate::library::generators::generator::{Generator, Misuse, whole_range};
use crate::model::NumberArg;
use crate::term::{Expr, Func, Term};

pub(crate) struct Fourier;

const USAGE: &str = "fourier(atom; n)";

impl Generator for Fourier {
    fn name(&self) -> &'static str {
        "fourier"
    }

    fn usage(&self) -> &'static str {
        USAGE
    }

    fn about(&self) -> &'static str {
        "sin(k*atom) and cos(k*atom), k = 1 … n"
    }

    fn of_angles(&self) -> bool {
        true
    }

    fn count(&self, atoms: usize, numbers: &[NumberArg]) -> Result<u128, Misuse> {
        let (from, to) = whole_range(numbers, "number of harmonics", 1, USAGE)?;
        Ok(2 * atoms as u128 * u128::from(to - from + 1))
    }

    fn expand(&self, atoms: &[Expr], numbers: &[NumberArg]) -> Result<Vec<Term>, Misuse> {
        let (from, to) = whole_range(numbers, "number of harmonics", 1, USAGE)?;
        let functions: Vec<Func> = ["sin", "cos"]
            .iter()
            .filter_map(|f| Func::named(f))
            .collect();
        let mut terms = Vec::new();
        for atom in atoms {
            for k in from..=to {
                let argument = atom.clone().scale(f64::from(k));
                terms.extend(
                    functions
                        .iter()
                        .map(|f| Expr::call(*f, vec![argument.clone()]).into_term().1),
                );
            }
        }
        Ok(terms)
    }
}
