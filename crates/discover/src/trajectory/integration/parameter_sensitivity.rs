//! Sensitivities to the coefficients, gathered from rows over all intervals into one matrix for each interval.
//!
//! In: gains and column values at three nodes of a step, each a row over all intervals. Out: U of each interval, n × P, at its slot.

use std::ops::Range;

use sidc_solve::simd::wide;

/// Columns that are transposed at once: so many stay in the first-level cache.
const COLUMNS_AT_ONCE: usize = 8;
/// Intervals that are integrated side by side.
pub(crate) const INTERVALS_AT_ONCE: usize = 64;

/// U of one step: Σ gain · column over the three nodes of Simpson's rule.
pub(crate) struct ParameterSensitivity<'a> {
    /// n × laws × intervals each.
    pub gains: [&'a [f64]; 3],
    /// P × intervals each.
    pub values: [&'a [f64]; 3],
    pub laws: usize,
    pub slots: &'a [usize],
    pub n: usize,
    /// Number P of columns.
    pub p: usize,
}

impl ParameterSensitivity<'_> {
    /// Adds the columns of each law to `out`, or overwrites it unless `onto`.
    pub fn add(&self, laws: &[Range<usize>], onto: bool, out: &mut [f64]) {
        for (l, range) in laws.iter().enumerate() {
            wide(|| self.law(l, range.clone(), onto, out));
        }
    }

    #[inline(always)]
    fn law(&self, law: usize, range: Range<usize>, onto: bool, out: &mut [f64]) {
        let (count, n, p) = (self.slots.len(), self.n, self.p);
        let mut tile = [[0.0; INTERVALS_AT_ONCE]; COLUMNS_AT_ONCE];
        for i in 0..n {
            let at = (i * self.laws + law) * count;
            let [g0, g1, g2] = self.gains.map(|g| &g[at..at + count]);
            for first in range.clone().step_by(COLUMNS_AT_ONCE) {
                let width = COLUMNS_AT_ONCE.min(range.end - first);
                for (j, line) in tile[..width].iter_mut().enumerate() {
                    let at = (first + j) * count;
                    let [v0, v1, v2] = self.values.map(|v| &v[at..at + count]);
                    for (b, x) in line[..count].iter_mut().enumerate() {
                        *x = g0[b] * v0[b] + g1[b] * v1[b] + g2[b] * v2[b];
                    }
                }
                for (b, slot) in self.slots.iter().enumerate() {
                    let at = (slot * n + i) * p + first;
                    for (x, line) in out[at..at + width].iter_mut().zip(&tile) {
                        *x = if onto { *x + line[b] } else { line[b] };
                    }
                }
            }
        }
    }
}

/// U ← T U, interval by interval. `whole` is n × n × intervals.
pub(crate) fn propagate(
    whole: &[f64],
    slots: &[usize],
    (n, p): (usize, usize),
    columns: &mut [f64],
    moved: &mut Vec<f64>,
) {
    let count = slots.len();
    if p == 0 {
        return;
    }
    wide(|| {
        for (b, slot) in slots.iter().enumerate() {
            let u = &mut columns[slot * n * p..(slot + 1) * n * p];
            moved.clear();
            moved.extend_from_slice(u);
            u.fill(0.0);
            for (i, to) in u.chunks_exact_mut(p).enumerate() {
                for (k, from) in moved.chunks_exact(p).enumerate() {
                    let weight = whole[(i * n + k) * count + b];
                    if weight != 0.0 {
                        to.iter_mut().zip(from).for_each(|(y, x)| *y += weight * x);
                    }
                }
            }
        }
    });
}

/// Rows over all intervals → the entries of each interval at its slot.
pub(crate) fn scatter(rows: &[f64], slots: &[usize], out: &mut [f64]) {
    let (count, size) = (slots.len(), rows.len() / slots.len());
    for (k, row) in rows.chunks_exact(count).enumerate() {
        for (slot, x) in slots.iter().zip(row) {
            out[slot * size + k] = *x;
        }
    }
}
