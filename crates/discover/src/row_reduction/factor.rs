//! The rows of one equation as the triangle R of [Φ y] = Q R.
//!
//! In: samples, or factors of other rows. Out: a factor of all of them (tall-skinny QR: Demmel, Grigori, Hoemmen & Langou 2012,
//! SIAM J. Sci. Comput. 34, A206). Sums of products would lose half of the digits of clean data.

use nalgebra::DMatrix;
use sidc_data::{Column, Origin, Samples};
use sidc_lang::library::Library;
use sidc_lang::term::{Signal, Term};
use sidc_solve::linalg::Qr;

use crate::dictionary::{BadValue, compile, subtract};
use crate::row_reduction::thresholds::ROW_REDUCTION;
use crate::row_weights::Weights;

/// Any number of rows of one equation with N candidate terms: R is (N + 1) × (N + 1), its last column that of the target.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    rows: usize,
    /// Those of them whose target was estimated, not measured.
    estimated: usize,
    r: DMatrix<f64>,
}

impl Factor {
    /// No rows.
    fn empty(terms: usize) -> Factor {
        Factor {
            rows: 0,
            estimated: 0,
            r: DMatrix::zeros(terms + 1, terms + 1),
        }
    }

    /// The rows of an equation on samples, weighted as regression weighs them.
    ///
    /// # Errors
    /// A term without a finite value.
    pub(crate) fn of(
        (target, known): (Signal, &[(f64, Term)]),
        library: &Library,
        samples: &Samples,
    ) -> Result<Factor, Box<BadValue>> {
        let mut y = samples
            .column(target)
            .map_or_else(|| vec![0.0; samples.len()], |c| c.values.clone());
        subtract(&mut y, known.iter().map(|(c, t)| (*c, t)), samples);
        let weights = Weights::new(samples, target, library, &y).row;
        let terms = library.len();
        let mut all = Factor::empty(terms);
        let most = ROW_REDUCTION
            .block_rows
            .max(ROW_REDUCTION.blocks_of_terms * terms);
        for first in (0..samples.len()).step_by(most) {
            let rows: Vec<usize> = (first..samples.len().min(first + most)).collect();
            let block = samples.select(&rows);
            let weights = &weights[first..first + rows.len()];
            let phi = compile(library, &block, Some(weights)).map_err(|mut bad| {
                bad.row += first;
                bad
            })?;
            let mut columns = vec![0.0; rows.len() * (terms + 1)];
            let (design, target) = columns.split_at_mut(rows.len() * terms);
            for (j, column) in design.chunks_exact_mut(rows.len()).enumerate() {
                phi.column(j, column);
            }
            for ((out, y), w) in target.iter_mut().zip(&y[first..]).zip(weights) {
                *out = y * w;
            }
            all.absorb(
                rows.len(),
                &DMatrix::from_vec(rows.len(), terms + 1, columns),
            );
        }
        let estimated = |c: &Column| matches!(c.origin, Origin::Estimated { .. });
        if samples.column(target).is_some_and(estimated) {
            all.estimated = all.rows;
        }
        Ok(all)
    }

    /// Adds the rows of another factor of as many terms.
    pub fn merge(&mut self, other: &Factor) {
        self.absorb(other.rows, &other.r);
        self.estimated += other.estimated;
    }

    fn absorb(&mut self, rows: usize, below: &DMatrix<f64>) {
        let n = self.r.ncols();
        let mut stacked = DMatrix::zeros(n + below.nrows(), n);
        stacked.rows_mut(0, n).copy_from(&self.r);
        stacked.rows_mut(n, below.nrows()).copy_from(below);
        self.r = Qr::new(stacked).r;
        self.rows += rows;
    }

    /// Rows M that were reduced.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Rows whose target was estimated, not measured.
    pub fn estimated(&self) -> usize {
        self.estimated
    }

    /// Candidate terms N.
    pub fn terms(&self) -> usize {
        self.r.ncols() - 1
    }

    /// R.
    pub(crate) fn r(&self) -> &DMatrix<f64> {
        &self.r
    }

    /// R, column by column, each down to its diagonal: (N + 1)(N + 2)/2 numbers.
    pub fn packed(&self) -> Vec<f64> {
        let column = |j: usize| {
            self.r
                .column(j)
                .iter()
                .take(j + 1)
                .copied()
                .collect::<Vec<_>>()
        };
        (0..self.r.ncols()).flat_map(column).collect()
    }

    /// The factor of these numbers; `None` if there are too few or too many, or one is not finite.
    pub fn unpacked(
        (rows, estimated): (usize, usize),
        terms: usize,
        packed: &[f64],
    ) -> Option<Factor> {
        let n = terms.checked_add(1)?;
        let length = n.checked_mul(n + 1)? / 2;
        if packed.len() != length || packed.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let entry = |i: usize, j: usize| match i <= j {
            true => packed[j * (j + 1) / 2 + i],
            false => 0.0,
        };
        let r = DMatrix::from_fn(n, n, entry);
        Some(Factor { rows, estimated, r })
    }
}
