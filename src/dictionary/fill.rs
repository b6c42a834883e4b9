//! Columns of terms, written once: a block of rows of every column, then the next block.
//!
//! In: terms, samples, row weights. Out: the columns one after another, and the sum of squares of each, taken while its
//! values are at hand. The factors of a block of rows stay in a core's cache meanwhile.

use super::cores;
use super::powers::{Plan, Table, TableBlock};
use crate::data::Samples;
use crate::term::Term;

/// Columns and their sums of squares.
pub(super) struct Filled {
    /// M × N, column-major; finite or not.
    pub values: Vec<f64>,
    /// Length N; infinite, zero or NaN where a number of that size cannot be squared.
    pub squares: Vec<f64>,
}

/// Groups of columns for each thread: enough to even out, few enough to read the factors seldom.
const GROUPS: usize = 4;

/// Every term on every row, each row multiplied by its weight if there are any.
pub(super) fn fill<'a>(
    terms: impl IntoIterator<Item = &'a Term>,
    samples: &Samples,
    weights: Option<&[f64]>,
) -> Filled {
    let plan = Plan::new(terms, weights.is_some());
    let table = plan.evaluate(samples, weights);
    let (rows, cols) = (samples.len().max(1), plan.terms.len());
    // Zeros come lazily from the system: a page is touched first when its column is written.
    let mut values = vec![0.0; samples.len() * cols];
    let mut squares = vec![0.0; cols];
    let threads = cores::threads_for(values.len());
    let group = cols.div_ceil(threads * GROUPS).max(1);
    let columns = values
        .chunks_mut(group * rows)
        .zip(squares.chunks_mut(group))
        .zip(plan.terms.chunks(group));
    cores::share(threads, columns, |tasks| {
        for ((values, squares), terms) in tasks {
            fill_group(&table, terms, values, squares, rows);
        }
    });
    Filled { values, squares }
}

fn fill_group(
    table: &Table,
    terms: &[Vec<u32>],
    values: &mut [f64],
    squares: &mut [f64],
    rows: usize,
) {
    for block in table.blocks() {
        let columns = values.chunks_exact_mut(rows).zip(&mut *squares);
        for ((column, squares), factors) in columns.zip(terms) {
            *squares += multiply(&block, factors, &mut column[block.rows.clone()]);
        }
    }
}

/// The product of some powers, from left to right, and its sum of squares.
fn multiply(block: &TableBlock, factors: &[u32], out: &mut [f64]) -> f64 {
    let power = |n: &u32| block.power(*n);
    match factors {
        [] => product::<0>([], out),
        [a] => product([a].map(power), out),
        [a, b] => product([a, b].map(power), out),
        [a, b, c] => product([a, b, c].map(power), out),
        [a, b, c, d] => product([a, b, c, d].map(power), out),
        [a, b, c, d, e] => product([a, b, c, d, e].map(power), out),
        [a, b, c, d, e, rest @ ..] => {
            product([a, b, c, d, e].map(power), out);
            multiply_on(block, rest, out)
        }
    }
}

/// The same for a product of many, begun in `out`.
fn multiply_on(block: &TableBlock, factors: &[u32], out: &mut [f64]) -> f64 {
    for factor in factors {
        let factor = block.power(*factor);
        out.iter_mut().zip(factor).for_each(|(o, f)| *o *= f);
    }
    super::sums::dot(out, out)
}

/// Rows that are multiplied side by side.
const LANES: usize = 8;

/// The product of K columns in one pass, and its sum of squares.
fn product<const K: usize>(factors: [&[f64]; K], out: &mut [f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let mut heads = factors.map(|f| f.chunks_exact(LANES));
    let tails = factors.map(|f| f.chunks_exact(LANES).remainder());
    let mut pieces = out.chunks_exact_mut(LANES);
    for piece in &mut pieces {
        let mut lanes = [1.0; LANES];
        for head in heads.iter_mut().filter_map(Iterator::next) {
            lanes.iter_mut().zip(head).for_each(|(l, f)| *l *= f);
        }
        piece.copy_from_slice(&lanes);
        sums.iter_mut().zip(lanes).for_each(|(s, l)| *s += l * l);
    }
    let mut rest = 0.0;
    for (i, out) in pieces.into_remainder().iter_mut().enumerate() {
        *out = tails.iter().map(|t| t[i]).product();
        rest += *out * *out;
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::super::compile::tests::{samples, x};
    use super::*;
    use crate::term::{Expr, power};

    #[test]
    fn any_number_of_factors_is_multiplied_from_left_to_right() {
        let samples = samples(&[0.5, -2.0, 3.0, 0.7, 1.1, -0.1, 0.3, 0.9, 1.3, -0.8, 2.0]);
        let weights: Vec<f64> = (1..=11).map(f64::from).collect();
        let atom = |k: u32| x() + Expr::number(f64::from(k));
        for weights in [None, Some(weights.as_slice())] {
            for many in 0..9 {
                let product = (0..many).fold(Term::one(), |t, k| t.mul(&atom(k).into_term().1));
                let filled = fill(&[Term::one(), product.clone()], &samples, weights);
                let column = &filled.values[11..];
                for (row, value) in column.iter().enumerate() {
                    let at = |s| samples.column(s).unwrap().values[row];
                    let mut wanted = weights.map_or(1.0, |w| w[row]);
                    for (atom, exponent) in product.factors() {
                        wanted *= power(atom.eval(&at), exponent);
                    }
                    assert_eq!(*value, wanted);
                }
                let squares: f64 = column.iter().map(|v| v * v).sum();
                assert!((filled.squares[1] / squares - 1.0).abs() < 1e-14);
            }
        }
    }
}
