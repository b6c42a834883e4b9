//! The dual basis of a set of columns: which part of the target needs which column.
//!
//! In: columns, the ridge that the assumption allows. Out: for each column the direction orthogonal to all others, and how much of
//! the target lies along it. Never decides what a support is.
//!
//! With |a_j| ≤ B on unit columns and at most K terms, ‖a‖² ≤ K B². A fit within ε is then a fit of the columns [A; √δ I] to the
//! target [y; 0] within √(ε² + δ K B²), and those columns are independent whatever A is. Their dual basis W, WᵀA = I, turns the
//! question which columns can be left out into projections: leaving out the columns of C adds the projection of the target on the
//! span of W_C to the residual.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::columns::Columns;
use crate::linalg::{Qr, dot_in_lanes, norm};
use crate::simd::{axpy, wide};
use crate::thresholds::SPARSEST;

/// Some columns with their ridge, triangular, and the target in the same coordinates.
pub(super) struct Triangle {
    /// The columns, by place.
    pub columns: Vec<usize>,
    /// Upper triangular, by columns.
    values: DMatrix<f64>,
    target: Vec<f64>,
    /// Squared part of the target that no column reaches.
    outside: f64,
}

/// The dual basis of those columns of a triangle that are not excluded yet.
#[derive(Clone)]
pub(super) struct DualBasis {
    pub triangle: Arc<Triangle>,
    /// Unit vectors by place, one after another; not used where `live` is false.
    vectors: Vec<f64>,
    /// Products of the target with them.
    pub along: Vec<f64>,
    pub live: Vec<bool>,
    /// The projection of the target on the directions of excluded columns.
    pub residual: Vec<f64>,
    /// Squared residual of all columns that are not excluded.
    pub square: f64,
}

impl Triangle {
    pub fn new(all: &Columns, columns: Vec<usize>, ridge: f64) -> Triangle {
        let (rows, n) = (all.rows, columns.len());
        let mut augmented = DMatrix::zeros(rows + n, n + 1);
        for (place, j) in columns.iter().enumerate() {
            let mut column = augmented.column_mut(place);
            column.rows_mut(0, rows).copy_from_slice(all.column(*j));
            column[rows + place] = ridge;
        }
        let mut last = augmented.column_mut(n);
        last.rows_mut(0, rows).copy_from_slice(&all.target);
        let r = Qr::new(augmented).r;
        let outside = match r.nrows() > n {
            true => r[(n, n)].powi(2),
            false => 0.0,
        };
        let target = r.column(n).iter().take(n).copied().collect();
        Triangle {
            columns,
            values: r.view((0, 0), (n, n)).into_owned(),
            target,
            outside,
        }
    }

    fn size(&self) -> usize {
        self.columns.len()
    }

    /// The part of a column that is not zero.
    fn column(&self, place: usize) -> &[f64] {
        let n = self.size();
        &self.values.as_slice()[place * n..place * n + place + 1]
    }

    /// φᵀλ of the columns at these places.
    pub fn products(&self, lambda: &[f64], places: &[usize]) -> Vec<f64> {
        let product = |p: &usize| dot_in_lanes::<8, f64>(self.column(*p), &lambda[..*p + 1]);
        wide(|| places.iter().map(product).collect())
    }

    /// x with φ_pᵀx = `right`_p, from the first place on where that is not zero.
    pub fn dual_of(&self, right: &[f64]) -> Vec<f64> {
        let n = self.size();
        let mut x = vec![0.0; n];
        let first = right.iter().position(|r| *r != 0.0).unwrap_or(n);
        wide(|| {
            for p in first..n {
                let column = self.column(p);
                let known = dot_in_lanes::<8, f64>(&column[first..p], &x[first..p]);
                x[p] = (right[p] - known) / nonzero(column[p]);
            }
        });
        x
    }

    /// (yᵀλ, ‖λ‖) where λ goes on with the part of the target that no column reaches.
    pub fn value(&self, lambda: &[f64]) -> (f64, f64) {
        let reached = dot_in_lanes::<8, f64>(lambda, &self.target) + self.outside;
        let square = dot_in_lanes::<8, f64>(lambda, lambda) + self.outside;
        (reached, square.sqrt())
    }
}

impl DualBasis {
    pub fn new(triangle: Triangle) -> DualBasis {
        let n = triangle.size();
        let mut vectors = Vec::with_capacity(n * n);
        let mut unit = vec![0.0; n];
        for p in 0..n {
            unit[p] = 1.0;
            let mut w = triangle.dual_of(&unit);
            unit[p] = 0.0;
            let length = norm(&w);
            w.iter_mut().for_each(|x| *x /= nonzero(length));
            vectors.extend(w);
        }
        let along = vectors
            .chunks_exact(n.max(1))
            .map(|w| dot_in_lanes::<8, f64>(w, &triangle.target))
            .collect();
        DualBasis {
            vectors,
            along,
            live: vec![true; n],
            residual: vec![0.0; n],
            square: triangle.outside,
            triangle: Arc::new(triangle),
        }
    }

    pub fn size(&self) -> usize {
        self.triangle.size()
    }

    pub fn vector(&self, place: usize) -> &[f64] {
        let n = self.size();
        &self.vectors[place * n..(place + 1) * n]
    }

    /// Takes a column away: its direction is no longer spanned.
    pub fn exclude(&mut self, place: usize) {
        if !std::mem::replace(&mut self.live[place], false) {
            return;
        }
        let n = self.size();
        let direction = self.vector(place).to_vec();
        let target = self.along[place];
        axpy(target, &direction, &mut self.residual);
        self.square += target * target;
        let vectors = self.vectors.chunks_exact_mut(n);
        let states = self.live.iter_mut().zip(&mut self.along);
        wide(|| {
            for (w, (live, along)) in vectors.zip(states).filter(|(_, (live, _))| **live) {
                let product = dot_in_lanes::<8, f64>(w, &direction);
                axpy(-product, &direction, w);
                let length = dot_in_lanes::<8, f64>(w, w).sqrt();
                // What rounding left of it points nowhere.
                *live = length > SPARSEST.lost_direction;
                w.iter_mut().for_each(|x| *x /= nonzero(length));
                *along = (*along - product * target) / nonzero(length);
            }
        });
    }
}

fn nonzero(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x }
}
