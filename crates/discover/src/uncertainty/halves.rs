//! Stability: on which halves of the records the same terms would have been chosen.
//!
//! In: products of stretches. Out: the share of halves in which each term found is chosen again. Halves come in complementary
//! pairs (Shah & Samworth, J. R. Stat. Soc. B 2013), of whole stretches, so that rows that follow each other stay together.

use super::sum;
use crate::SplitMix;
use sidc_solve::QuadraticForm;
use sidc_system::discovery::{Halves, Stretches};

/// Complementary pairs.
const PAIRS: usize = 25;
/// Fewest stretches that are worth dealing out.
const FEWEST: usize = 4;
const SEED: u64 = 1;

/// How the halves were drawn, and each found term's share of them; `None` of too few stretches.
pub(super) fn halves(stretches: &Stretches) -> Option<(Halves, Vec<f64>)> {
    let count = stretches.products.len();
    if count < FEWEST {
        return None;
    }
    let mut chosen = vec![0usize; stretches.support.len()];
    let mut random = SplitMix::new(SEED);
    let mut order: Vec<usize> = (0..count).collect();
    for _ in 0..PAIRS {
        shuffle(&mut order, &mut random);
        let (first, second) = order.split_at(count / 2);
        for half in [first, second] {
            let support = best(stretches, half);
            for (times, place) in chosen.iter_mut().zip(&stretches.support) {
                *times += usize::from(support.contains(place));
            }
        }
    }
    let drawn = 2 * PAIRS;
    let share = |times: usize| times as f64 / drawn as f64;
    let halves = Halves {
        stretches: count,
        drawn,
        among: stretches.columns.len(),
        seed: SEED,
    };
    Some((halves, chosen.into_iter().map(share).collect()))
}

/// The best terms on some stretches: from those found, and from the one that explains most, single changes as far as they help.
fn best(stretches: &Stretches, half: &[usize]) -> Vec<usize> {
    let columns = stretches.columns.len();
    let products = half.iter().filter_map(|i| stretches.products.get(*i));
    let form = QuadraticForm::new(&sum(products, columns + 1), columns);
    let (_, price) = stretches.price;
    let strongest =
        (0..form.p).max_by(|i, j| form.right[*i].abs().total_cmp(&form.right[*j].abs()));
    let starts = [stretches.support.clone(), strongest.into_iter().collect()];
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
