//! The regression of one equation, as normal equations over whole records.
//!
//! In: normal equations by block. Out: those of the columns that one equation may use. Never sees rows.

use sidc_lang::term::{Signal, Term};
use sidc_solve::QuadraticForm;
use sidc_system::discovery::BlockNormalEquations;

/// The columns that one equation may use, and the terms found for the other equations, which stay.
pub(super) struct TargetRegression<'a> {
    pub blocks: &'a BlockNormalEquations,
    /// Their numbers among the columns of the blocks, rising.
    pub columns: Vec<usize>,
    pub form: QuadraticForm,
    /// The terms found, by position in `columns`.
    pub support: Vec<usize>,
}

impl TargetRegression<'_> {
    /// Without the column `excluded`, if there is one.
    pub fn new(
        blocks: &BlockNormalEquations,
        target: Signal,
        excluded: Option<usize>,
    ) -> TargetRegression<'_> {
        let included = |(p, (t, _)): &(usize, &(Signal, Term))| {
            Some(*p) != excluded && (*t == target || blocks.support.contains(p))
        };
        let columns = blocks.columns.iter().enumerate().filter(included);
        let columns: Vec<usize> = columns.map(|(p, _)| p).collect();
        let (w, last) = (blocks.columns.len() + 1, blocks.columns.len());
        let indices = || columns.iter().copied().chain([last]);
        let products: Vec<f64> = indices()
            .flat_map(|i| indices().map(move |j| i * w + j))
            .map(|at| blocks.whole.get(at).copied().unwrap_or(0.0))
            .collect();
        let position = |p: &usize| columns.binary_search(p).ok();
        TargetRegression {
            form: QuadraticForm::new(&products, columns.len()),
            support: blocks.support.iter().filter_map(position).collect(),
            columns,
            blocks,
        }
    }

    /// The target and the term of the column at position `k`.
    pub fn column(&self, k: usize) -> Option<&(Signal, Term)> {
        self.blocks.columns.get(*self.columns.get(k)?)
    }

    /// Twice the log likelihood ratio of a difference of χ², with the noise level profiled out.
    pub fn likelihood_ratio(&self, chi_square: f64) -> f64 {
        let readings = self.blocks.readings;
        readings * (chi_square / readings).ln_1p()
    }
}

/// The sum of the normal equations of some blocks, width × width by rows.
pub(super) fn sum_blocks<'a>(
    products: impl Iterator<Item = &'a Vec<f64>>,
    width: usize,
) -> Vec<f64> {
    let mut sum = vec![0.0; width * width];
    for block in products {
        sum.iter_mut().zip(block).for_each(|(s, x)| *s += x);
    }
    sum
}
