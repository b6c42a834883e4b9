//! The last columns of a support, by closed form instead of branching.
//!
//! In: columns, their sketch, those included. Out: every support that fits with one, two or three columns more. Never misses one:
//! what fits on all rows fits on the sketch, and what fits there is tested on all rows.

use std::ops::Range;

use super::columns::{Columns, mixing_rows, project_off};
use super::pairs::Pairs;
use crate::linalg::dot_in_lanes;
use crate::simd::wide;
use crate::thresholds::{NUMERICAL_RANK, SPARSEST};

/// The free columns of the sketch, the included ones projected off.
pub(super) struct Leaf<'a> {
    all: &'a Columns,
    included: &'a [usize],
    free: &'a [usize],
    rows: usize,
    /// The free columns, in their order.
    columns: Vec<f64>,
    target: Vec<f64>,
    /// A unit vector without a pattern, by which directions are told apart.
    probe: Vec<f64>,
    /// Squared lengths of the columns, their products with the target and with the probe.
    lengths: Vec<f64>,
    along: Vec<f64>,
    probed: Vec<f64>,
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
        let probe = mixing_rows(rows, 1);
        let each = columns.chunks_exact(rows.max(1));
        let products = |with: &[f64]| -> Vec<f64> {
            let each = each.clone();
            wide(|| each.map(|c| dot_in_lanes::<8, f64>(c, with)).collect())
        };
        let (along, probed) = (products(&target), products(&probe));
        let lengths = each.clone().map(|c| dot_in_lanes::<8, f64>(c, c)).collect();
        Leaf {
            all,
            included,
            free,
            rows,
            columns,
            target,
            probe,
            lengths,
            along,
            probed,
        }
    }

    /// Multiplications that [`Leaf::new`] takes.
    pub fn work(rows: usize, included: usize, free: usize) -> f64 {
        (4 * rows * free * (included + 1)) as f64
    }

    /// Supports with one column more.
    pub fn singles(&self) -> Vec<Vec<usize>> {
        let here = self.pairs_of(0..self.free.len());
        let passing = here.singles().into_iter().map(|i| self.support(&[i]));
        passing.filter(|s| self.all.fits(s)).collect()
    }

    /// Supports with two columns more.
    pub fn pairs(&self) -> Vec<Vec<usize>> {
        let here = self.pairs_of(0..self.free.len());
        let product = |i: usize, j: usize| dot_in_lanes::<8, f64>(self.column(i), self.column(j));
        let passing = here.pairs(&product).into_iter();
        let passing = passing.map(|(i, j)| self.support(&[i, j]));
        passing.filter(|s| self.all.fits(s)).collect()
    }

    /// Supports with the column at `first` and two after it.
    pub fn triples(&self, first: usize) -> Vec<Vec<usize>> {
        let length = self.lengths[first].sqrt();
        if length <= NUMERICAL_RANK.dependent {
            // A column in the span of the included ones adds nothing: what fits with it fits without.
            return Vec::new();
        }
        let mut direction = self.column(first).to_vec();
        direction.iter_mut().for_each(|x| *x /= length);
        let (target, probe) = (self.along[first] / length, self.probed[first] / length);
        let after = first + 1..self.free.len();
        let products: Vec<f64> = wide(|| {
            let product = |j: usize| dot_in_lanes::<8, f64>(self.column(j), &direction);
            after.clone().map(product).collect()
        });
        let mut rest = self.pairs_of(after.clone());
        rest.target_probed -= target * probe;
        let mut left = self.target.clone();
        project_off(&mut left, &direction);
        rest.square = dot_in_lanes::<8, f64>(&left, &left);
        for (k, p) in products.iter().enumerate() {
            rest.lengths[k] = (rest.lengths[k] - p * p).max(0.0);
            rest.target_products[k] -= p * target;
            rest.probe_products[k] -= p * probe;
        }
        let product = |i: usize, j: usize| {
            let whole =
                dot_in_lanes::<8, f64>(self.column(first + 1 + i), self.column(first + 1 + j));
            whole - products[i] * products[j]
        };
        let passing = rest.pairs(&product).into_iter();
        let passing = passing.map(|(i, j)| self.support(&[first, first + 1 + i, first + 1 + j]));
        passing.filter(|s| self.all.fits(s)).collect()
    }

    fn pairs_of(&self, places: Range<usize>) -> Pairs {
        Pairs {
            lengths: self.lengths[places.clone()].to_vec(),
            target_products: self.along[places.clone()].to_vec(),
            probe_products: self.probed[places].to_vec(),
            target_probed: dot_in_lanes::<8, f64>(&self.target, &self.probe),
            square: dot_in_lanes::<8, f64>(&self.target, &self.target),
            allowed: self.all.square.max(0.0),
        }
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

/// Multiplications of [`Leaf::pairs`] on so many rows and columns.
pub(super) fn pairs_work(all: &Columns, rows: usize, free: usize) -> f64 {
    match all.square <= SPARSEST.sketch_tolerance.powi(2) {
        true => (2 * rows * free) as f64,
        false => (rows * free * free) as f64 / 2.0,
    }
}
