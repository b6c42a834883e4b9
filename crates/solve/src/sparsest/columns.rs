//! The columns of a problem brought to length one and to few rows, and the exact test whether some of them fit.
//!
//! In: a problem. Out: columns, target and tolerance of a smaller problem with the same residuals; a sketch of its rows. Never
//! looks for supports.

use nalgebra::DMatrix;

use crate::dictionary::{unit_columns, usable_columns};
use crate::linalg::{Qr, dot_in_lanes, norm};
use crate::problem::Problem;
use crate::simd::{axpy, wide};
use crate::thresholds::{CERTIFICATES, NUMERICAL_RANK, SPARSEST};

/// Unit columns and a target of length one, on at most as many rows as columns.
pub(super) struct Columns {
    pub rows: usize,
    /// The columns, one after another.
    pub values: Vec<f64>,
    pub target: Vec<f64>,
    /// Columns of the dictionary.
    pub kept: Vec<usize>,
    /// Largest squared residual of a fit on these rows, relative to ‖y‖²; negative where no support fits.
    pub square: f64,
}

impl Columns {
    /// Of a problem whose numbers are finite and whose target is not zero.
    pub fn new(problem: &Problem) -> Columns {
        let kept = usable_columns(problem.dictionary);
        let norm_of = |j: &usize| problem.dictionary.norm(*j);
        let norms: Vec<f64> = kept.iter().map(norm_of).collect();
        let unit = unit_columns(problem.dictionary, &kept, &norms);
        let length = norm(problem.target);
        let tolerance = (problem.tolerance / length).max(CERTIFICATES.consistent);
        let square = (tolerance * (1.0 + CERTIFICATES.feasible)).powi(2);
        let (m, n) = unit.shape();
        let scaled = problem.target.iter().map(|y| y / length);
        let values: Vec<f64> = unit.as_slice().iter().copied().chain(scaled).collect();
        let whole = DMatrix::from_vec(m, n + 1, values);
        let (reduced, outside) = match m > n + 1 {
            true => {
                let r = Qr::new(whole).r;
                let outside = r[(n, n)].powi(2);
                (r.remove_row(n), outside)
            }
            false => (whole, 0.0),
        };
        let rows = reduced.nrows();
        let (values, target) = reduced.as_slice().split_at(rows * n);
        Columns {
            rows,
            values: values.to_vec(),
            target: target.to_vec(),
            kept,
            square: square - outside,
        }
    }

    pub fn count(&self) -> usize {
        self.kept.len()
    }

    pub fn column(&self, j: usize) -> &[f64] {
        &self.values[j * self.rows..(j + 1) * self.rows]
    }

    /// Columns of the dictionary.
    pub fn named(&self, support: &[usize]) -> Vec<usize> {
        let mut named: Vec<usize> = support.iter().map(|j| self.kept[*j]).collect();
        named.sort_unstable();
        named
    }

    /// Whether the target is within the tolerance of the span of these columns.
    pub fn fits(&self, support: &[usize]) -> bool {
        self.residual_square(support) <= self.square
    }

    /// The squared residual of least squares on these columns.
    pub fn residual_square(&self, support: &[usize]) -> f64 {
        let mut left = self.target.clone();
        for direction in self.directions(support) {
            project_off(&mut left, &direction);
        }
        dot_in_lanes::<8, f64>(&left, &left)
    }

    /// An orthonormal basis of these columns: Gram–Schmidt twice, which is enough (Giraud, Langou & Rozložník 2005).
    pub fn directions(&self, support: &[usize]) -> Vec<Vec<f64>> {
        let mut basis: Vec<Vec<f64>> = Vec::with_capacity(support.len());
        for j in support {
            let mut direction = self.column(*j).to_vec();
            for _ in 0..2 {
                basis.iter().for_each(|b| project_off(&mut direction, b));
            }
            let length = norm(&direction);
            if length > NUMERICAL_RANK.dependent {
                direction.iter_mut().for_each(|x| *x /= length);
                basis.push(direction);
            }
        }
        basis
    }

    /// The same problem on fewer rows that are random combinations of all: what fits on all of them fits on these. Where ε is not
    /// small, fewer rows would let too much pass, and all are kept.
    pub fn sketch(&self) -> Columns {
        let few = SPARSEST.sketch_rows;
        if self.rows <= few || self.square > SPARSEST.sketch_tolerance.powi(2) {
            return Columns {
                values: self.values.clone(),
                target: self.target.clone(),
                kept: self.kept.clone(),
                ..*self
            };
        }
        let mixed = mixing_rows(self.rows, few);
        let reduce = |column: &[f64]| -> Vec<f64> {
            let rows = mixed.chunks_exact(self.rows);
            rows.map(|row| dot_in_lanes::<8, f64>(row, column))
                .collect()
        };
        let columns = self.values.chunks_exact(self.rows.max(1));
        Columns {
            rows: few,
            values: columns.flat_map(reduce).collect(),
            target: reduce(&self.target),
            kept: self.kept.clone(),
            square: self.square,
        }
    }
}

/// `few` orthonormal vectors of length `rows`, one after another, from a fixed sequence of numbers without a pattern.
pub(super) fn mixing_rows(rows: usize, few: usize) -> Vec<f64> {
    let mut state = 1_u64;
    let mut next = || {
        // Knuth's linear congruence modulo 2⁶⁴.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let random = DMatrix::from_fn(rows, few, |_, _| next());
    let qr = Qr::new(random);
    qr.q_mul(DMatrix::identity(few, few)).as_slice().to_vec()
}

/// v − (dᵀv) d, for a unit vector d.
pub(super) fn project_off(vector: &mut [f64], direction: &[f64]) {
    wide(|| {
        let along = dot_in_lanes::<8, f64>(vector, direction);
        axpy(-along, direction, vector);
    });
}
