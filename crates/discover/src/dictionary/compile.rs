//! Library × samples → Φ: a single list of terms is stored as a matrix, products of lists stay factors.
//!
//! In: a library, samples, row weights. Out: the dictionary, or the term, row and value at fault. Weighs and chooses no terms.

use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::term::{Atom, Signal, Term, power};
use sidc_solve::dictionary::{Block, Dense, Dictionary, Factored};

use super::column_products::fill;
use super::expression_values::RowBlock;
use super::factor_table::Plan;

/// A term without a finite value somewhere in the data.
#[derive(Clone, Debug)]
pub struct BadValue {
    pub term: Term,
    /// The factor at fault; `None` if only the product overflows.
    pub atom: Option<Atom>,
    /// Row of the samples, from 0.
    pub row: usize,
    /// The value of the factor's first argument there, or of the factor itself.
    pub value: f64,
}

/// Φ of a library on samples, each row multiplied by `weights[row]` if given. Columns are the library's slots.
///
/// A library that is one list without empty slots becomes a [`Dense`] matrix, any other a [`Factored`] one, where a product is evaluated
/// as its two factors: `1/x` times `x` is not finite at 0.
///
/// # Errors
/// The first term, in the order of slots, that is not finite somewhere, with its first such row.
pub fn compile(
    library: &Library,
    samples: &Samples,
    weights: Option<&[f64]>,
) -> Result<Box<dyn Dictionary>, Box<BadValue>> {
    match listed(library) {
        Some(terms) => Ok(Box::new(dense(terms, samples, weights)?)),
        None => Ok(Box::new(factored(library, samples, weights)?)),
    }
}

/// Most memory that [`compile`] and pricing take, in bytes: Φ or its factors, a length for every slot, and the table of powers. Evaluates
/// nothing.
pub fn bytes(library: &Library, rows: usize) -> u128 {
    let blocks = library.blocks();
    // Right factors are kept in single precision too, and in double precision where that does not suffice.
    let factors = |b: &sidc_lang::library::Block| (8 * b.left.len() + 20 * b.right.len()) as u128;
    let slots = |b: &sidc_lang::library::Block| b.left.len() as u128 * b.right.len() as u128;
    let rows = rows as u128;
    let columns = match listed(library) {
        Some(terms) => 8 * terms.len() as u128 * (rows + 1),
        None => {
            rows * blocks.iter().map(factors).sum::<u128>()
                + 2 * blocks.iter().map(slots).sum::<u128>()
        }
    };
    let powers = Plan::new(library.factors(), true).count() as u128;
    columns + 8 * powers * rows
}

/// Values of one term on every row, finite or not.
pub fn evaluate(term: &Term, samples: &Samples) -> Vec<f64> {
    let rows = 0..samples.len();
    let mut values = vec![0.0; samples.len()];
    RowBlock { samples, rows }.term(term, &mut values);
    values
}

/// y ← y − Σ coefficient · term on every row.
pub fn subtract<'a>(
    y: &mut [f64],
    terms: impl IntoIterator<Item = (f64, &'a Term)>,
    samples: &Samples,
) {
    for (coefficient, term) in terms {
        let values = evaluate(term, samples);
        y.iter_mut()
            .zip(&values)
            .for_each(|(y, v)| *y -= coefficient * v);
    }
}

/// The terms of a library that is a single list without empty slots.
pub(super) fn listed(library: &Library) -> Option<&[Term]> {
    match library.blocks() {
        [b] if library.empty_slots().is_empty()
            && matches!(b.right.as_slice(), [r] if r.is_one()) =>
        {
            Some(&b.left)
        }
        _ => None,
    }
}

pub(super) fn dense(
    terms: &[Term],
    samples: &Samples,
    weights: Option<&[f64]>,
) -> Result<Dense, Box<BadValue>> {
    let filled = fill(terms, samples, weights);
    let rows = samples.len().max(1);
    let columns = filled.values.chunks_exact(rows).zip(&filled.squares);
    for (term, (column, squares)) in terms.iter().zip(columns) {
        if !squares.is_finite()
            && let Some(row) = column.iter().position(|v| !v.is_finite())
        {
            return Err(Box::new(explain([term, &Term::one()], row, samples)));
        }
    }
    Ok(Dense::filled(rows, filled.values, &filled.squares))
}

fn factored(
    library: &Library,
    samples: &Samples,
    weights: Option<&[f64]>,
) -> Result<Factored, Box<BadValue>> {
    let (blocks, [lefts, rights]) = factors(library);
    let left = fill(lefts.iter().copied(), samples, weights).values;
    let right = fill(rights.iter().copied(), samples, None).values;
    Factored::new(samples.len(), [left, right], blocks, library.empty_slots()).map_err(|bad| {
        let [l, r] = bad.factors;
        Box::new(explain([lefts[l], rights[r]], bad.row, samples))
    })
}

/// The blocks of a library that have slots, and their left and right factors, one block after another.
pub(super) fn factors(library: &Library) -> (Vec<Block>, [Vec<&Term>; 2]) {
    let used = || library.blocks().iter().filter(|b| b.slots() > 0);
    let lefts: Vec<&Term> = used().flat_map(|b| &b.left).collect();
    let rights: Vec<&Term> = used().flat_map(|b| &b.right).collect();
    let mut blocks: Vec<Block> = Vec::new();
    for b in used() {
        let (first_slot, left, right) = blocks.last().map_or((0, 0, 0), Block::ends);
        blocks.push(Block {
            first_slot,
            left: left..left + b.left.len(),
            right: right..right + b.right.len(),
        });
    }
    (blocks, [lefts, rights])
}

fn explain(factors: [&Term; 2], row: usize, samples: &Samples) -> BadValue {
    let at = |s: Signal| samples.column(s).map_or(f64::NAN, |c| c.values[row]);
    let [left, right] = factors;
    let term = left.mul(right);
    let culprit = factors
        .into_iter()
        .flat_map(Term::factors)
        .find(|(atom, p)| !power(atom.eval(&at), *p).is_finite());
    let value = match culprit {
        Some((Atom::Call(_, args), _)) => args.first().map_or(f64::NAN, |a| a.eval(&at)),
        Some((atom, _)) => atom.eval(&at),
        None => term.eval(&at),
    };
    BadValue {
        term,
        atom: culprit.map(|(a, _)| a.clone()),
        row,
        value,
    }
}
