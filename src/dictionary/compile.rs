//! Library × samples → Φ: each distinct factor is evaluated once, its powers once, and columns are products of those.

use std::collections::BTreeMap;

use super::{Dense, Dictionary};
use crate::data::Samples;
use crate::library::Library;
use crate::term::{Atom, Signal, Term};

/// A term without a finite value somewhere in the data.
#[derive(Clone, Debug)]
pub struct BadValue {
    pub term: Term,
    /// The factor at fault; `None` if only the product overflows.
    pub atom: Option<Atom>,
    /// Row of the samples, from 0.
    pub row: usize,
    /// What the factor's first argument (or the factor itself) is there.
    pub value: f64,
}

/// Φ of a library on samples, each row multiplied by `weights[row]` if given. Columns are the library's slots.
///
/// # Errors
/// The first term (in library order) that is not finite somewhere, with its first such row.
pub fn compile(
    library: &Library,
    samples: &Samples,
    weights: Option<&[f64]>,
) -> Result<Box<dyn Dictionary>, Box<BadValue>> {
    let terms: Vec<Term> = library.terms().map(|(_, t)| t).collect();
    let dense = evaluate_all(&terms, samples, weights)?;
    if library.empty_slots().is_empty() {
        return Ok(Box::new(dense));
    }
    let mut values = vec![0.0; samples.len() * library.slots()];
    let rows = samples.len().max(1);
    let columns = dense.values().chunks_exact(rows);
    for ((slot, _), column) in library.terms().zip(columns) {
        values[slot * rows..(slot + 1) * rows].copy_from_slice(column);
    }
    Ok(Box::new(Dense::new(samples.len(), values)))
}

/// Every term on every row: M × N, column-major.
fn evaluate_all(
    terms: &[Term],
    samples: &Samples,
    weights: Option<&[f64]>,
) -> Result<Dense, Box<BadValue>> {
    let rows = samples.len();
    let mut factors = Factors::default();
    let mut values = Vec::with_capacity(rows * terms.len());
    for term in terms {
        let start = values.len();
        match weights {
            Some(w) => values.extend_from_slice(w),
            None => values.resize(start + rows, 1.0),
        }
        let column = &mut values[start..];
        for (atom, power) in term.factors() {
            let factor = factors.powered(atom, power, samples);
            column.iter_mut().zip(factor).for_each(|(c, f)| *c *= f);
        }
        if let Some(row) = column.iter().position(|v| !v.is_finite()) {
            return Err(Box::new(explain(term, row, samples)));
        }
    }
    Ok(Dense::new(rows, values))
}

/// Values of one term on every row, finite or not.
pub fn evaluate(term: &Term, samples: &Samples) -> Vec<f64> {
    (0..samples.len())
        .map(|row| term.eval(&|s| value(samples, s, row)))
        .collect()
}

/// Each factor's powers, computed when first needed.
#[derive(Default)]
struct Factors {
    /// Power by the bits of its exponent: the exponents are few and exact.
    powers: BTreeMap<Atom, Vec<(u64, Vec<f64>)>>,
}

impl Factors {
    fn powered(&mut self, atom: &Atom, power: f64, samples: &Samples) -> &[f64] {
        let known = self
            .powers
            .entry(atom.clone())
            .or_insert_with(|| vec![(1f64.to_bits(), evaluate_atom(atom, samples))]);
        let place = known.iter().position(|(p, _)| *p == power.to_bits());
        let place = place.unwrap_or_else(|| {
            let raised = known[0]
                .1
                .iter()
                .map(|x| crate::term::power(*x, power))
                .collect();
            known.push((power.to_bits(), raised));
            known.len() - 1
        });
        &known[place].1
    }
}

fn evaluate_atom(atom: &Atom, samples: &Samples) -> Vec<f64> {
    if let Atom::Signal(s) = atom
        && let Some(c) = samples.column(*s)
    {
        return c.values.clone();
    }
    (0..samples.len())
        .map(|row| atom.eval(&|s| value(samples, s, row)))
        .collect()
}

/// NaN stands for a signal that the samples lack; the caller asked for every signal it mentions.
fn value(samples: &Samples, s: Signal, row: usize) -> f64 {
    samples.column(s).map_or(f64::NAN, |c| c.values[row])
}

fn explain(term: &Term, row: usize, samples: &Samples) -> BadValue {
    let at = |s: Signal| value(samples, s, row);
    let culprit = term
        .factors()
        .find(|(atom, p)| !crate::term::power(atom.eval(&at), *p).is_finite());
    let value = match culprit {
        Some((Atom::Call(_, args), _)) => args.first().map_or(f64::NAN, |a| a.eval(&at)),
        Some((atom, _)) => atom.eval(&at),
        None => term.eval(&at),
    };
    BadValue {
        term: term.clone(),
        atom: culprit.map(|(a, _)| a.clone()),
        row,
        value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Column, Origin};
    use crate::term::{Expr, Func, VarId};

    fn samples() -> Samples {
        let signal = Signal::new(VarId(1));
        Samples {
            trajectory: vec![0; 3],
            time: vec![0.0, 1.0, 2.0],
            columns: vec![Column {
                signal,
                values: vec![1.0, -2.0, 3.0],
                origin: Origin::Measured,
            }],
        }
    }

    fn x() -> Expr {
        Expr::signal(Signal::new(VarId(1)))
    }

    #[test]
    fn columns_are_weighted_products() {
        let term = x().pow(3.0).into_term().1;
        let phi = evaluate_all(&[Term::one(), term], &samples(), Some(&[1.0, 2.0, 1.0])).unwrap();
        assert_eq!(phi.values(), &[1.0, 2.0, 1.0, 1.0, -16.0, 27.0]);
        assert!((phi.norms()[0] - 6f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn the_row_and_value_of_a_bad_logarithm_are_named() {
        let log = Expr::call(Func::named("log").unwrap(), vec![x()]);
        let bad = evaluate_all(&[log.into_term().1], &samples(), None).unwrap_err();
        assert_eq!((bad.row, bad.value), (1, -2.0));
    }
}
