//! Which rows the coefficients are found from, and which are left to test them.
//!
//! In: how many rows and terms there are. Out: row numbers, drawn without replacement where not all are used. Never looks at values.

use crate::random::SplitMix;
use crate::regression::thresholds::ROW_BUDGET;

/// Most rows for an equation with this many candidates.
fn affordable(terms: usize) -> usize {
    let stored = ROW_BUDGET.stored_entries / terms.max(1);
    let priced = (ROW_BUDGET.priced_entries / terms.max(1))
        .min(terms)
        .min(ROW_BUDGET.wide_rows);
    stored.max(priced).max(ROW_BUDGET.min_rows)
}

/// Row indices, rising.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Split {
    pub used: Vec<usize>,
    pub held: Vec<usize>,
    /// True if rows were left out only to keep Φ within its limit.
    pub limited: bool,
}

/// How many of `rows` rows [`split`] uses.
pub(crate) fn used(rows: usize, terms: usize, samples: Option<usize>) -> usize {
    samples.unwrap_or_else(|| affordable(terms)).min(rows)
}

/// Splits `rows` rows into those used and those held out: `samples` of them if given, else as many as Φ with `terms` columns may
/// have.
///
/// ```
/// use sidc_discover::split;
///
/// let drawn = split(1000, 6561, Some(40), 7);
/// assert_eq!((drawn.used.len(), drawn.held.len()), (40, 960));
/// assert!(drawn.used.is_sorted());
/// ```
pub fn split(rows: usize, terms: usize, samples: Option<usize>, seed: u64) -> Split {
    let wanted = used(rows, terms, samples);
    if wanted == rows {
        return Split {
            used: (0..rows).collect(),
            ..Split::default()
        };
    }
    let mut order: Vec<usize> = (0..rows).collect();
    let mut random = SplitMix::new(seed);
    for i in 0..wanted {
        // Fisher–Yates shuffle, stopped once enough rows are drawn.
        let j = i + random.below(rows - i);
        order.swap(i, j);
    }
    let mut held = order.split_off(wanted);
    order.sort_unstable();
    held.sort_unstable();
    Split {
        used: order,
        held,
        limited: samples.is_none(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_used_or_held_once() {
        let s = split(50, 10, Some(20), 7);
        assert_eq!((s.used.len(), s.held.len(), s.limited), (20, 30, false));
        let mut all = [s.used, s.held].concat();
        all.sort_unstable();
        assert_eq!(all, (0..50).collect::<Vec<_>>());
    }

    #[test]
    fn seeds_draw_different_rows_and_large_tables_are_limited() {
        assert_ne!(
            split(50, 10, Some(20), 1).used,
            split(50, 10, Some(20), 2).used
        );
        let s = split(10_000, 6_561, None, 0);
        assert_eq!((s.used.len(), s.limited), (2000, true));
        assert_eq!(split(300, 6_561, Some(1000), 0).used.len(), 300);
    }
}
