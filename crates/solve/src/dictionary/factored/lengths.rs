//! Lengths of columns, over the scales of their factors.
//!
//! In: scaled factors. Out: a length for each slot, or the first slot that is not finite. Where squares under- or overflow the column itself is
//! measured.

use std::ops::Range;

use super::Factored;
use super::length::Length;
use super::tiles::Task;
use crate::linalg::norm;
use crate::threads;

/// Squares of which nothing underflowed that matters.
const SAFE: Range<f32> = 1e-20..1e30;
/// Entries of a product of factors with such scales are finite, and so are its norm and its products with λ.
const SAFE_SCALES: Range<f64> = 1e-280..1e280;

/// What a look at some columns found.
#[derive(Default)]
struct Measured {
    /// The first slot that is not finite.
    bad: Option<usize>,
    /// A column of numbers has a norm that is none.
    overflow: bool,
}

/// Whether a length is the root of `square`; `scale` is the product of the scales of its factors.
#[inline(always)]
fn is_safe(square: f32, scale: f64) -> bool {
    SAFE.contains(&square) & SAFE_SCALES.contains(&scale)
}

impl Factored {
    /// Lengths of all slots; what stands in empty ones is undefined. Whether all norms are finite.
    ///
    /// # Errors
    /// The first slot that is not finite.
    pub(super) fn measure(
        &self,
        threads: usize,
        empty: &[usize],
        lengths: &mut [Length],
    ) -> Result<bool, usize> {
        let squares: Vec<f32> = self.scaled_right.iter().map(|x| x * x).collect();
        let mut rest = lengths;
        let tasks = self.tasks().map(|task| {
            let lengths = rest.split_off_mut(..task.slots().len()).unwrap_or_default();
            (task, lengths)
        });
        let found = threads::share(threads, tasks, |tasks| {
            let mut found = Measured::default();
            for (task, lengths) in tasks {
                self.measure_task(&task, &squares, empty, lengths, &mut found);
            }
            found
        });
        match found.iter().filter_map(|m| m.bad).min() {
            Some(slot) => Err(slot),
            None => Ok(!found.iter().any(|m| m.overflow)),
        }
    }

    fn measure_task(
        &self,
        task: &Task,
        right_squares: &[f32],
        empty: &[usize],
        lengths: &mut [Length],
        found: &mut Measured,
    ) {
        let [left_scales, right_scales] = &self.scales;
        let square = |l: usize, column: &[f64], out: &mut [f32]| {
            let inverse = 1.0 / left_scales[l];
            let scaled = column.iter().map(|x| (x * inverse) as f32);
            out.iter_mut().zip(scaled).for_each(|(o, x)| *o = x * x);
        };
        let all = |_: Range<usize>, _: Range<usize>| true;
        self.products(task, right_squares, all, square, |l, right, squares| {
            let slot = task.block.slot(l, right.start);
            let lengths = &mut lengths[slot - task.slots().start..][..squares.len()];
            let mut safe = true;
            for ((length, square), scale) in
                lengths.iter_mut().zip(squares).zip(&right_scales[right])
            {
                *length = Length::of(square.sqrt());
                safe &= is_safe(*square, left_scales[l] * scale);
            }
            if !safe {
                self.measure_exactly(slot, squares, empty, lengths, found);
            }
            true
        });
    }

    /// Lengths of those columns whose squares or scales are not safe.
    fn measure_exactly(
        &self,
        first: usize,
        squares: &[f32],
        empty: &[usize],
        lengths: &mut [Length],
        found: &mut Measured,
    ) {
        let mut column = vec![0.0; self.rows];
        for (slot, (square, length)) in (first..).zip(squares.iter().zip(lengths)) {
            let [l, r] = self.factors(slot);
            let safe = is_safe(*square, self.scales[0][l] * self.scales[1][r]);
            if safe || empty.binary_search(&slot).is_ok() {
                continue;
            }
            self.product(slot, &mut column);
            if found.bad.is_none_or(|bad| slot < bad) && column.iter().any(|x| !x.is_finite()) {
                found.bad = Some(slot);
            }
            let exact = norm(&column);
            found.overflow |= !exact.is_finite();
            *length = match exact == 0.0 {
                true => Length::NONE,
                false => Length::UNKNOWN,
            };
        }
    }
}
