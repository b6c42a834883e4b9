//! The last one or two columns of a support, by closed form instead of branching.
//!
//! In: columns, their sketch, those included. Out: every support that fits with one or two columns more. Never misses one: what
//! fits on all rows fits on the sketch, and what fits there is tested on all rows.

use super::columns::{Columns, project_off};
use crate::linalg::dot_in_lanes;
use crate::simd::{axpy, wide};
use crate::thresholds::{NUMERICAL_RANK, SPARSEST};

/// The sketch with the included columns projected off.
pub(super) struct Leaf<'a> {
    all: &'a Columns,
    included: &'a [usize],
    rows: usize,
    /// The free columns, in their order.
    columns: Vec<f64>,
    free: &'a [usize],
    target: Vec<f64>,
    /// Squared lengths of the free columns.
    lengths: Vec<f64>,
    along: Vec<f64>,
    square: f64,
}

impl<'a> Leaf<'a> {
    pub fn new(
        (all, sketch): (&'a Columns, &Columns),
        included: &'a [usize],
        free: &'a [usize],
    ) -> Leaf<'a> {
        let rows = sketch.rows;
        let mut target = sketch.target.clone();
        let mut columns = Vec::with_capacity(rows * free.len());
        free.iter()
            .for_each(|j| columns.extend_from_slice(sketch.column(*j)));
        for direction in sketch.directions(included) {
            project_off(&mut target, &direction);
            let columns = columns.chunks_exact_mut(rows.max(1));
            columns.for_each(|c| project_off(c, &direction));
        }
        let each = columns.chunks_exact(rows.max(1));
        let products = |with: Option<&[f64]>| -> Vec<f64> {
            let each = each.clone();
            wide(|| {
                each.map(|c| dot_in_lanes::<8>(c, with.unwrap_or(c)))
                    .collect()
            })
        };
        let (lengths, along) = (products(None), products(Some(&target)));
        let square = dot_in_lanes::<8>(&target, &target);
        Leaf {
            all,
            included,
            rows,
            columns,
            free,
            target,
            lengths,
            along,
            square,
        }
    }

    /// Multiplications that [`Leaf::new`] took.
    pub fn work(&self) -> f64 {
        (4 * self.rows * self.free.len() * (self.included.len() + 1)) as f64
    }

    /// Supports with one column more.
    pub fn singles(&self) -> Vec<Vec<usize>> {
        let places = 0..self.free.len();
        let passes = |i: &usize| self.passes(self.square, self.along[*i], self.lengths[*i]);
        let found = places.filter(passes).map(|i| self.support(&[i]));
        found.filter(|s| self.all.fits(s)).collect()
    }

    /// Supports with two columns more.
    pub fn pairs(&self) -> Vec<Vec<usize>> {
        let mut found = Vec::new();
        for first in 0..self.free.len() {
            self.pairs_with(first, &mut found);
        }
        found
    }

    /// Multiplications of [`Leaf::pairs`].
    pub fn pairs_work(&self) -> f64 {
        (self.rows * self.free.len() * self.free.len() / 2) as f64
    }

    /// Supports with a column and one after it.
    fn pairs_with(&self, first: usize, found: &mut Vec<Vec<usize>>) {
        if self.lengths[first] <= NUMERICAL_RANK.dependent.powi(2) {
            // Spanned by the included columns: a pair with it fits where the other alone does.
            return;
        }
        let length = self.lengths[first].sqrt();
        let mut direction = self.column(first).to_vec();
        direction.iter_mut().for_each(|x| *x /= length);
        let target = self.along[first] / length;
        let mut left = self.target.clone();
        axpy(-target, &direction, &mut left);
        let square = dot_in_lanes::<8>(&left, &left);
        let after = first + 1..self.free.len();
        let products: Vec<f64> = wide(|| {
            let product = |j: usize| dot_in_lanes::<8>(self.column(j), &direction);
            after.clone().map(product).collect()
        });
        for (j, product) in after.zip(products) {
            let along = self.along[j] - product * target;
            if self.passes(square, along, self.lengths[j] - product * product) {
                let support = self.support(&[first, j]);
                if self.all.fits(&support) {
                    found.push(support);
                }
            }
        }
    }

    /// Whether a column of this squared length and product with the target may bring the residual within the tolerance; rounding
    /// is given the benefit of the doubt.
    fn passes(&self, square: f64, along: f64, length: f64) -> bool {
        let allowed = self.all.square + SPARSEST.screening * self.square;
        (square - allowed) * length <= along * along + SPARSEST.screening * self.square
    }

    fn column(&self, place: usize) -> &[f64] {
        &self.columns[place * self.rows..(place + 1) * self.rows]
    }

    fn support(&self, places: &[usize]) -> Vec<usize> {
        let more = places.iter().map(|i| self.free[*i]);
        let mut support: Vec<usize> = self.included.iter().copied().chain(more).collect();
        support.sort_unstable();
        support
    }
}
