//! Which rows the coefficients are found from, and which are left to test them.

/// Most entries M · N of a Φ that is stored: 32 MB, and a second of least squares where rows outnumber terms.
const STORED: usize = 4_000_000;
/// Most products M · N of a Φ that is only priced: some 20 ms a look at all columns.
const PRICED: usize = 1_000_000_000;
/// Terms from which on more rows than these tell nothing new, but every step of a solver pays for them.
const MANY: usize = 2000;
/// Fewest rows that the limits leave.
const FEWEST: usize = 100;

/// Rows that an equation with `terms` candidates is found from, if there are so many.
fn affordable(terms: usize) -> usize {
    let stored = STORED / terms.max(1);
    let priced = (PRICED / terms.max(1)).min(terms).min(MANY);
    stored.max(priced).max(FEWEST)
}

/// Row indices, rising.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Split {
    pub used: Vec<usize>,
    pub held: Vec<usize>,
    /// True if rows were left out though nobody asked, to keep Φ within its limit.
    pub limited: bool,
}

/// Splits `rows` rows: `samples` of them if asked for, else as many as Φ with `terms` columns may have.
///
/// ```
/// use sidc::discover::split;
///
/// let drawn = split(1000, 6561, Some(40), 7);
/// assert_eq!((drawn.used.len(), drawn.held.len()), (40, 960));
/// assert!(drawn.used.is_sorted());
/// ```
pub fn split(rows: usize, terms: usize, samples: Option<usize>, seed: u64) -> Split {
    let fits = affordable(terms);
    let wanted = samples.unwrap_or(fits).min(rows);
    if wanted == rows {
        return Split {
            used: (0..rows).collect(),
            ..Split::default()
        };
    }
    let mut order: Vec<usize> = (0..rows).collect();
    let mut random = SplitMix::new(seed);
    for i in 0..wanted {
        // Fisher–Yates, only as far as needed.
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

/// SplitMix64 (Steele, Lea & Flood 2014): small, and the same on every machine.
pub struct SplitMix(u64);

impl SplitMix {
    pub fn new(seed: u64) -> Self {
        SplitMix(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normal with variance one (Box & Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }

    /// A number under `n`, which is small: as good as equally likely.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n.max(1) as u64) as usize
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
