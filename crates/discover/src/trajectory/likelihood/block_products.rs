//! The linearised likelihood about an answer, block by block of the records: what any choice of terms would cost on some of them.
//!
//! In: a problem and its fit. Out: normal equations of the columns found and of those nearest to replacing one, for each block. Each
//! block has a free first state, so all blocks together know a little less than the whole.

use sidc_progress::Observer;
use std::ops::Range;

use super::fitted_support::Fit;
use crate::trajectory::least_squares::NormalEquations;
use crate::trajectory::model::{Problem, Record, segments};
use crate::trajectory::thresholds::RESIDUALS;

/// Normal equations of some columns on blocks of the records.
#[derive(Clone, Debug)]
pub struct BlockProducts {
    /// Columns of the system, rising.
    pub columns: Vec<usize>,
    /// Products of these p columns and the right side, last, on each block: (p + 1) × (p + 1) by rows, in units of the noise.
    pub products: Vec<Vec<f64>>,
    /// The same on whole records.
    pub whole: Vec<f64>,
}

/// `None` where the records are too short to be divided, the laws diverge, or the observer ends the work.
pub fn block_products(
    problem: &Problem,
    fit: &Fit,
    inefficiency: f64,
    observer: &mut dyn Observer,
) -> Option<BlockProducts> {
    let point = &fit.point;
    let (form, whole) = problem.quadratic_and_products(point, observer).ok()?;
    let mut columns = point.support.clone();
    for m in form.single_changes(&point.support, 0.0, 4 * RESIDUALS.block_rivals) {
        columns.extend(m.enters.filter(|j| !columns.contains(j)));
        if columns.len() >= point.support.len() + RESIDUALS.block_rivals {
            break;
        }
    }
    columns.sort_unstable();
    let blocks = blocks(problem);
    if blocks.len() < RESIDUALS.min_blocks {
        return None;
    }
    let all = problem.all.outputs();
    let used: usize = blocks.iter().flatten().map(|(_, s)| s.len()).sum();
    let share = problem.samples() as f64 / used as f64;
    let part = |products: &[f64], share: f64| -> Vec<f64> {
        let places = || columns.iter().copied().chain([all]);
        places()
            .flat_map(|i| places().map(move |j| (i, j)))
            .map(|(i, j)| products[i * (all + 1) + j] * share / inefficiency)
            .collect()
    };
    let products = blocks.iter().map(|block| {
        let mut normal_equations = NormalEquations::new(all);
        problem
            .linearise(point, block, &mut normal_equations, observer)
            .ok()?;
        Some(part(&normal_equations.shifted(&point.active()), share))
    });
    let products = products.collect::<Option<Vec<_>>>()?;
    Some(BlockProducts {
        whole: part(&whole, 1.0),
        products,
        columns,
    })
}

/// Blocks, each of a few neighbouring parts of records. They are few and long, since long ones determine the phase of oscillations.
fn blocks(problem: &Problem) -> Vec<Vec<(usize, Range<usize>)>> {
    let lengths: Vec<usize> = problem.records.iter().map(Record::len).collect();
    let parts = segments(&lengths);
    let total: usize = parts.iter().map(|(_, s)| s.len()).sum();
    let length =
        (RESIDUALS.block_samples * problem.states()).max(total.div_ceil(RESIDUALS.max_blocks));
    let mut parts_of_blocks = Vec::new();
    for (record, samples) in parts {
        let count = (samples.len() / length).max(1);
        let edge = |i: usize| samples.start + i * samples.len() / count;
        parts_of_blocks.extend((0..count).map(|i| (record, edge(i)..edge(i + 1))));
    }
    // A single sample has no interval.
    parts_of_blocks.retain(|(_, s)| s.len() > 1);
    let count = parts_of_blocks.len().min(RESIDUALS.max_blocks);
    let mut blocks = vec![Vec::new(); count];
    let all = parts_of_blocks.len();
    for (i, part) in parts_of_blocks.into_iter().enumerate() {
        if let Some(block) = blocks.get_mut(i * count / all) {
            block.push(part);
        }
    }
    blocks
}
