//! From rows of all intervals to intervals one by one.
//!
//! In: quantities of a block, each a row of all intervals. Out: the same by intervals, each at its slot. Never knows what they mean.

use std::ops::Range;

use crate::lanes::wide;

/// Columns handed out at once, and most intervals.
const TILE: usize = 8;
const BLOCK: usize = super::flow::BLOCK;

/// U of one step: gains at three nodes times columns there.
pub(super) struct Columns<'a> {
    /// n × laws × intervals each.
    pub gains: [&'a [f64]; 3],
    /// P × intervals each.
    pub values: [&'a [f64]; 3],
    pub laws: usize,
    pub slots: &'a [usize],
    pub n: usize,
    /// P
    pub p: usize,
}

impl Columns<'_> {
    /// The columns of each law, onto what is there or in its place.
    pub fn add(&self, laws: &[Range<usize>], onto: bool, out: &mut [f64]) {
        for (l, range) in laws.iter().enumerate() {
            wide(|| self.law(l, range.clone(), onto, out));
        }
    }

    #[inline(always)]
    fn law(&self, law: usize, range: Range<usize>, onto: bool, out: &mut [f64]) {
        let (count, n, p) = (self.slots.len(), self.n, self.p);
        let mut tile = [[0.0; BLOCK]; TILE];
        for i in 0..n {
            let at = (i * self.laws + law) * count;
            let [g0, g1, g2] = self.gains.map(|g| &g[at..at + count]);
            for first in range.clone().step_by(TILE) {
                let width = TILE.min(range.end - first);
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
pub(super) fn follow(
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

/// Each interval's entries to its slot.
pub(super) fn lay_out(rows: &[f64], slots: &[usize], out: &mut [f64]) {
    let (count, size) = (slots.len(), rows.len() / slots.len());
    for (k, row) in rows.chunks_exact(count).enumerate() {
        for (slot, x) in slots.iter().zip(row) {
            out[slot * size + k] = *x;
        }
    }
}
