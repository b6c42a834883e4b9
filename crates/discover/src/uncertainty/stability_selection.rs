//! Complementary pairs stability selection (Meinshausen & Bühlmann 2010; Shah & Samworth, J. R. Stat. Soc. B 2013).
//!
//! In: normal equations by block. Out: for each term found, the share of half records on which it is selected again. Blocks are
//! assigned as a whole, so that rows that follow each other stay together.

use super::target_regression::sum_blocks;
use super::thresholds::STABILITY_SELECTION;
use crate::SplitMix;
use sidc_solve::QuadraticForm;
use sidc_system::discovery::{BlockNormalEquations, Halves};

const SEED: u64 = 1;

/// How often the terms found are selected again on half of the blocks.
#[derive(Clone, Debug)]
pub struct Stability {
    pub halves: Halves,
    /// The share of the halves that selects each term found.
    pub shares: Vec<f64>,
}

/// Selects on random halves of the blocks; `None` for too few blocks.
pub fn stability_selection(blocks: &BlockNormalEquations) -> Option<Stability> {
    let count = blocks.products.len();
    if count < STABILITY_SELECTION.min_blocks {
        return None;
    }
    let mut chosen = vec![0usize; blocks.support.len()];
    let mut random = SplitMix::new(SEED);
    let mut order: Vec<usize> = (0..count).collect();
    for _ in 0..STABILITY_SELECTION.complementary_pairs {
        shuffle(&mut order, &mut random);
        let (first, second) = order.split_at(count / 2);
        for half in [first, second] {
            let support = select(blocks, half);
            for (times, column) in chosen.iter_mut().zip(&blocks.support) {
                *times += usize::from(support.contains(column));
            }
        }
    }
    let drawn = 2 * STABILITY_SELECTION.complementary_pairs;
    let share = |times: usize| times as f64 / drawn as f64;
    let halves = Halves {
        stretches: count,
        drawn,
        among: blocks.columns.len(),
        seed: SEED,
    };
    Some(Stability {
        halves,
        shares: chosen.into_iter().map(share).collect(),
    })
}

/// The support selected on some blocks: the better end of two descents by single changes, one from the support found, one from the
/// term that correlates most with the target.
fn select(blocks: &BlockNormalEquations, half: &[usize]) -> Vec<usize> {
    let columns = blocks.columns.len();
    let products = half.iter().filter_map(|i| blocks.products.get(*i));
    let form = QuadraticForm::new(&sum_blocks(products, columns + 1), columns);
    let (_, price) = blocks.price;
    let strongest =
        (0..form.p).max_by(|i, j| form.right[*i].abs().total_cmp(&form.right[*j].abs()));
    let starts = [blocks.support.clone(), strongest.into_iter().collect()];
    let ends = starts.iter().map(|s| form.steepest_descent(s, price));
    let value = |s: &Vec<usize>| form.least_squares(s).square + price * s.len() as f64;
    ends.min_by(|a, b| value(a).total_cmp(&value(b)))
        .unwrap_or_default()
}

fn shuffle(order: &mut [usize], random: &mut SplitMix) {
    for i in (1..order.len()).rev() {
        order.swap(i, random.below(i + 1));
    }
}
