//! Columns of terms as products of tabulated factors, block by block of rows, so that the factors of a block stay in the cache.
//!
//! In: terms, samples, row weights. Out: the columns, and the sum of squares of each, taken while its values are at hand.

use super::factor_table::{Plan, Table, TableBlock};
use sidc_data::Samples;
use sidc_lang::term::Term;
use sidc_solve::linalg::dot_in_lanes;
use sidc_solve::threads;

/// Columns and their sums of squares.
pub(super) struct Filled {
    /// M × N, column-major; finite or not.
    pub values: Vec<f64>,
    /// Length N; infinite, zero or NaN where a number of that size cannot be squared.
    pub squares: Vec<f64>,
}

/// Groups of columns for each thread: enough to balance the load, few enough to read the factors seldom.
const GROUPS_PER_THREAD: usize = 4;

/// Rows that are multiplied and then squared while in the first cache.
const ROWS_AT_ONCE: usize = 256;

/// Every term on every row, each row multiplied by its weight if there are any.
pub(super) fn fill<'a>(
    terms: impl IntoIterator<Item = &'a Term>,
    samples: &Samples,
    weights: Option<&[f64]>,
) -> Filled {
    let plan = Plan::new(terms, weights.is_some());
    let table = plan.evaluate(samples, weights);
    let (rows, cols) = (samples.len().max(1), plan.terms.len());
    // The system gives zero pages lazily: a page is first touched when its column is written.
    let mut values = vec![0.0; samples.len() * cols];
    let mut squares = vec![0.0; cols];
    let threads = threads::threads_for(values.len());
    let group = cols.div_ceil(threads * GROUPS_PER_THREAD).max(1);
    let columns = values
        .chunks_mut(group * rows)
        .zip(squares.chunks_mut(group))
        .zip(plan.terms.chunks(group));
    threads::share(threads, columns, |tasks| {
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
    let mut prefix = Prefix::default();
    for block in table.blocks() {
        prefix.factors.clear();
        let columns = values.chunks_exact_mut(rows).zip(&mut *squares);
        for ((column, squares), factors) in columns.zip(terms) {
            let out = &mut column[block.rows.clone()];
            *squares += match factors.split_last() {
                None => {
                    out.fill(1.0);
                    dot_in_lanes::<8, f64>(out, out)
                }
                Some((only, [])) => {
                    out.copy_from_slice(block.power(*only));
                    dot_in_lanes::<8, f64>(out, out)
                }
                Some((last, first)) => {
                    multiply(prefix.product(&block, first), block.power(*last), out)
                }
            };
        }
    }
}

/// Products of a term's first factors, which the next term mostly shares: terms come sorted.
#[derive(Default)]
struct Prefix {
    factors: Vec<u32>,
    /// The product of the first two factors, of the first three, …
    products: Vec<Vec<f64>>,
}

impl Prefix {
    /// The product of at least one factor, from left to right.
    fn product<'a>(&'a mut self, block: &TableBlock<'a>, factors: &[u32]) -> &'a [f64] {
        let pairs = self.factors.iter().zip(factors);
        let shared = pairs.take_while(|(a, b)| a == b).count();
        for (k, factor) in factors.iter().enumerate().skip(shared.max(1)) {
            if self.products.len() < k {
                self.products.push(Vec::new());
            }
            let (before, rest) = self.products.split_at_mut(k - 1);
            let before = before.last().map_or(block.power(factors[0]), Vec::as_slice);
            rest[0].resize(before.len(), 0.0);
            multiply(before, block.power(*factor), &mut rest[0]);
        }
        self.factors.truncate(shared);
        self.factors.extend_from_slice(&factors[shared..]);
        match factors.len() {
            1 => block.power(factors[0]),
            many => &self.products[many - 2],
        }
    }
}

/// The product of two columns; returns its sum of squares.
fn multiply(a: &[f64], b: &[f64], out: &mut [f64]) -> f64 {
    let factors = a.chunks(ROWS_AT_ONCE).zip(b.chunks(ROWS_AT_ONCE));
    let mut squares = 0.0;
    for (out, (a, b)) in out.chunks_mut(ROWS_AT_ONCE).zip(factors) {
        let products = a.iter().zip(b).map(|(a, b)| a * b);
        out.iter_mut().zip(products).for_each(|(o, p)| *o = p);
        squares += dot_in_lanes::<8, f64>(out, out);
    }
    squares
}
