//! Pricing: the columns of largest correlation above a bound.
//!
//! In: λ, grades, a bound. Out: [`Priced`], in double precision. Products in single precision tell most columns from those asked for; the others
//! are computed again, column by column. Where most columns are left open, all products are of double precision.

use std::cell::Cell;
use std::ops::Range;

use super::length::Length;
use super::rounding::{Line, Rounding};
use super::tiles::{Scaled, scaled};
use super::{Factored, LANES, column_norm};
use crate::dictionary::grades::Grades;
use crate::dictionary::pricing::{Priced, PricingCollector};
use crate::linalg::{correlation, norm};
use crate::simd::wide;
use crate::threads;

/// Products in single precision are given up where more than one column in so many is left open: a column costs as much as 8 of them.
const OPEN_SHARE: usize = 8;
/// Columns that may be left open before that. Only time depends on these two.
const OPEN: usize = 4096;

/// A pricing in one precision.
struct Screening<'a, T> {
    phi: &'a Factored,
    grades: Option<&'a Grades>,
    lambda: &'a [f64],
    rounding: Rounding,
    /// Right factors as [`super::tiles::scaled`] lays them out, and their grades.
    right: &'a [T],
    right_grades: Vec<T>,
    /// Most columns that are computed again.
    patience: usize,
}

/// What one thread has found.
struct Found {
    collector: PricingCollector,
    /// Columns seen, and computed again.
    seen: usize,
    open: usize,
    column: Vec<f64>,
}

impl Factored {
    /// Prices all columns. Tiles whose grades alone keep them within the bound are not computed.
    pub(super) fn price_on(
        &self,
        threads: usize,
        grades: Option<&Grades>,
        lambda: &[f64],
        wanted: (usize, f64),
    ) -> Priced {
        if wanted.1 < 0.0 {
            // Every column exceeds the bound; an infinite length would seem to.
            return self.price_each(grades, lambda, wanted);
        }
        let found = Rounding::new::<f32>(lambda).and_then(|rounding| {
            let screening =
                Screening::new(self, grades, lambda, rounding, &self.scaled_right, OPEN);
            screening.price(threads, wanted)
        });
        found.unwrap_or_else(|| self.price_in_double(threads, grades, lambda, wanted))
    }

    fn price_in_double(
        &self,
        threads: usize,
        grades: Option<&Grades>,
        lambda: &[f64],
        wanted: (usize, f64),
    ) -> Priced {
        let Some(rounding) = Rounding::new::<f64>(lambda) else {
            return match norm(lambda) == 0.0 {
                true => Priced::default(),
                // Not a number, or too small to be scaled.
                false => self.price_each(grades, lambda, wanted),
            };
        };
        let right: Vec<f64> = scaled(&self.right, &self.scales[1], self.rows, &self.blocks);
        let screening = Screening::new(self, grades, lambda, rounding, &right, usize::MAX);
        screening.price(threads, wanted).unwrap_or_default()
    }

    /// Column by column.
    pub(super) fn price_each(
        &self,
        grades: Option<&Grades>,
        lambda: &[f64],
        (most, bound): (usize, f64),
    ) -> Priced {
        let mut collector = PricingCollector::new(most, bound);
        let mut column = vec![0.0; self.rows];
        for slot in (0..self.lengths.len()).filter(|slot| !self.is_empty(*slot)) {
            let grade = grades.map_or(1.0, |g| g.of(slot));
            collector.offer(slot, self.correlation(slot, lambda, &mut column) / grade);
        }
        collector.finish()
    }

    /// φ_jᵀλ/‖φ_j‖ of a slot that is not empty.
    fn correlation(&self, slot: usize, lambda: &[f64], column: &mut [f64]) -> f64 {
        self.product(slot, column);
        let norm = column_norm(column);
        wide(|| correlation::<LANES>(column, norm, lambda))
    }
}

impl<'a, T: Scaled> Screening<'a, T> {
    fn new(
        phi: &'a Factored,
        grades: Option<&'a Grades>,
        lambda: &'a [f64],
        rounding: Rounding,
        right: &'a [T],
        patience: usize,
    ) -> Screening<'a, T> {
        let count = right.len() / phi.rows.max(1);
        let grade = |r| T::of(grades.map_or(1.0, |g| g.right(r)));
        Screening {
            phi,
            grades,
            lambda,
            rounding,
            right,
            right_grades: (0..count).map(grade).collect(),
            patience,
        }
    }

    /// `None` where too many columns are left open.
    fn price(&self, threads: usize, (most, bound): (usize, f64)) -> Option<Priced> {
        let (phi, scale) = (self.phi, self.rounding.scale);
        let grade = |l: usize| self.grades.map_or(1.0, |g| g.left(l));
        let prepare = |l: usize, column: &[f64], out: &mut [T]| {
            let (inverse, grade) = (1.0 / phi.scales[0][l], 1.0 / (scale * grade(l)));
            let prepared = column.iter().zip(self.lambda);
            let prepared = prepared.map(|(x, l)| T::of(x * inverse * (l * grade)));
            out.iter_mut().zip(prepared).for_each(|(o, p)| *o = p);
        };
        let length = norm(self.lambda);
        let found = threads::share(threads, phi.tasks(), |tasks| {
            // What is kept rises, and dismisses more and more tiles.
            let threshold = Cell::new(bound);
            let wanted = |left: Range<usize>, right: Range<usize>| {
                let graded = self.grades;
                graded.is_none_or(|g| !g.dismiss(left, right, length, threshold.get()))
            };
            let mut found = Found {
                collector: PricingCollector::new(most, bound),
                seen: 0,
                open: 0,
                column: vec![0.0; phi.rows],
            };
            for task in tasks {
                let all = phi.products(&task, self.right, wanted, prepare, |l, right, products| {
                    let slot = task.block.slot(l, right.start);
                    self.screen(
                        slot,
                        grade(l),
                        (products, &self.right_grades[right]),
                        &mut found,
                    );
                    threshold.set(found.collector.threshold());
                    found.open <= self.patience.max(found.seen / OPEN_SHARE)
                });
                if !all {
                    return None;
                }
            }
            Some(found.collector)
        });
        let collectors: Option<Vec<PricingCollector>> = found.into_iter().collect();
        collectors.map(PricingCollector::finish_all)
    }

    /// Takes consecutive products with one left factor. Columns below what is kept are left out, and the others are computed.
    fn screen(
        &self,
        first: usize,
        grade: f64,
        (products, grades): (&[T], &[T]),
        found: &mut Found,
    ) {
        let lengths = &self.phi.lengths[first..first + products.len()];
        let line = self.rounding.below(found.collector.threshold(), grade);
        let (groups, rest) = products.as_chunks::<LANES>();
        let (group_grades, rest_grades) = grades.as_chunks::<LANES>();
        let (group_lengths, rest_lengths) = lengths.as_chunks::<LANES>();
        let mut open = Vec::new();
        wide(|| {
            let groups = groups.iter().zip(group_grades).zip(group_lengths);
            for (at, ((s, g), n)) in (first..).step_by(LANES).zip(groups) {
                if !all_below(line, s, g, n) {
                    open.extend(not_below(line, at, s.iter().zip(g).zip(n)));
                }
            }
        });
        let at = first + groups.len() * LANES;
        open.extend(not_below(
            line,
            at,
            rest.iter().zip(rest_grades).zip(rest_lengths),
        ));
        found.seen += products.len();
        for slot in open {
            if !self.phi.is_empty(slot) {
                found.open += 1;
                let exact = self.phi.correlation(slot, self.lambda, &mut found.column);
                let grade = self.grades.map_or(1.0, |grades| grades.of(slot));
                found.collector.offer(slot, exact / grade);
            }
        }
    }
}

/// Whether no column of a group may be kept.
#[inline(always)]
fn all_below<T: Scaled>(
    line: Line<T>,
    products: &[T; LANES],
    grades: &[T; LANES],
    lengths: &[Length; LANES],
) -> bool {
    let mut all = true;
    for k in 0..LANES {
        all &= line.is_above(products[k], grades[k], lengths[k]);
    }
    all
}

/// The columns that may be kept, of those from `first` on.
fn not_below<'a, T: Scaled>(
    line: Line<T>,
    first: usize,
    columns: impl Iterator<Item = ((&'a T, &'a T), &'a Length)>,
) -> impl Iterator<Item = usize> {
    let open = (first..).zip(columns);
    let open = open.filter(move |(_, ((s, g), n))| !line.is_above(**s, **g, **n));
    open.map(|(slot, _)| slot)
}
