//! Sums over the weighted rows of one equation in 106 bits: its residual, the lengths of its columns, their products.
//!
//! In: samples, which rows, their weights; terms with coefficients. Out: [`WeightedSums`]. One pass over the rows, of which none is kept.

use super::ball::Ball;
use super::double_double::{DoubleDouble, ROUNDING};
use super::term_evaluation;
use super::thresholds::TILES;
use sidc_data::Samples;
use sidc_lang::term::{Signal, Term};
use sidc_progress::Observer;

/// Squares of smaller numbers may fall below the range of f64, which ends at 4.9e-324 = (2.2e-162)².
const UNDERFLOWING: f64 = 1e-161;

/// Rows of samples with their weights.
pub struct WeightedRows<'a> {
    samples: &'a Samples,
    used: &'a [usize],
    weights: &'a [f64],
}

/// What is summed: y is the target less the known terms, r = y − Σ a φ.
pub struct SumRequest<'a> {
    pub target: Signal,
    pub known: &'a [(&'a Term, f64)],
    pub found: &'a [(&'a Term, f64)],
    /// One number for each row; empty if no sums with it are needed.
    pub dual: &'a [f64],
    /// Whether products of the columns with each other are needed.
    pub gram: bool,
}

/// Sums over weighted rows.
pub struct WeightedSums {
    /// ‖y‖
    pub target: Ball,
    /// ‖r‖
    pub residual: Ball,
    /// ‖φ_j‖ of each term found.
    pub norms: Vec<Ball>,
    /// φ_jᵀr
    pub gradient: Vec<DoubleDouble>,
    /// φ_jᵀφ_l for l ≤ j, row after row; empty if not requested.
    pub gram: Vec<DoubleDouble>,
    /// yᵀλ and ‖λ‖
    pub target_dual: Ball,
    pub dual_norm: Ball,
}

/// A sum of squares, and the sum of the squares of the errors.
#[derive(Clone, Copy, Default)]
struct SquareSum {
    sum: DoubleDouble,
    error_square: f64,
}

impl SquareSum {
    fn add_square(&mut self, x: Ball) {
        self.sum = self.sum + x.value * x.value;
        self.error_square += x.error * x.error;
    }

    /// The root of the sum: a length.
    fn length(self, rows: usize) -> Ball {
        let value = self.sum.sqrt();
        let rounding = (rows as f64 + 4.0) * ROUNDING * value.hi;
        let lost = (rows as f64).sqrt() * UNDERFLOWING;
        let error = self.error_square.sqrt() * (1.0 + 1e-9) + rounding + lost;
        match value.is_finite() && error.is_finite() {
            true => Ball { value, error },
            false => Ball {
                value,
                error: f64::INFINITY,
            },
        }
    }
}

impl<'a> WeightedRows<'a> {
    /// `None` if a row is not among the samples, or lacks a weight.
    pub fn new(
        samples: &'a Samples,
        used: &'a [usize],
        weights: &'a [f64],
    ) -> Option<WeightedRows<'a>> {
        let there = used.iter().all(|r| *r < samples.len()) && used.is_sorted_by(|a, b| a < b);
        let weighted =
            weights.len() == used.len() && weights.iter().all(|w| *w >= 0.0 && w.is_finite());
        (there && weighted).then_some(WeightedRows {
            samples,
            used,
            weights,
        })
    }

    pub fn len(&self) -> usize {
        self.used.len()
    }

    pub fn weight(&self, row: usize) -> f64 {
        self.weights.get(row).copied().unwrap_or(f64::NAN)
    }

    /// The value of a signal at a row; NaN where there is none.
    pub fn at(&self, row: usize) -> impl Fn(Signal) -> f64 {
        move |s| {
            let column = self.samples.column(s);
            let place = self.used.get(row).copied();
            let value = column.zip(place).and_then(|(c, r)| c.values.get(r));
            value.copied().unwrap_or(f64::NAN)
        }
    }

    /// Sums over all rows; `None` if the observer ended it.
    pub fn sums(&self, request: &SumRequest, observer: &mut dyn Observer) -> Option<WeightedSums> {
        let k = request.found.len();
        let (mut target, mut residual, mut dual) = (
            SquareSum::default(),
            SquareSum::default(),
            SquareSum::default(),
        );
        let mut norms = vec![SquareSum::default(); k];
        let mut gradient = vec![DoubleDouble::ZERO; k];
        let mut gram = vec![DoubleDouble::ZERO; if request.gram { k * (k + 1) / 2 } else { 0 }];
        let (mut product, mut product_error, mut product_size) = (DoubleDouble::ZERO, 0.0, 0.0);
        let mut values = vec![Ball::default(); k];
        for row in 0..self.len() {
            if row % TILES.observed_rows == 0 && !observer.go_on() {
                return None;
            }
            let (at, weight) = (self.at(row), self.weight(row));
            let mut y = Ball::exact(at(request.target));
            for (term, a) in request.known {
                y = y.add(term_evaluation::term(term, &at).scale(*a).negative());
            }
            let y = y.scale(weight);
            let mut r = y;
            for ((term, a), v) in request.found.iter().zip(&mut values) {
                *v = term_evaluation::term(term, &at).scale(weight);
                r = r.add(v.scale(*a).negative());
            }
            target.add_square(y);
            residual.add_square(r);
            for (j, v) in values.iter().enumerate() {
                norms[j].add_square(*v);
                gradient[j] = gradient[j] + v.value * r.value;
            }
            if request.gram {
                let pairs = (0..k).flat_map(|j| (0..=j).map(move |l| (j, l)));
                for (sum, (j, l)) in gram.iter_mut().zip(pairs) {
                    *sum = *sum + values[j].value * values[l].value;
                }
            }
            if let Some(lambda) = request.dual.get(row) {
                dual.add_square(Ball::exact(*lambda));
                let part = y.value * *lambda;
                product = product + part;
                product_error += y.error * lambda.abs();
                product_size += part.hi.abs();
            }
        }
        let rows = self.len();
        let rounding = 2.0 * (rows as f64 + 4.0) * ROUNDING * product_size;
        Some(WeightedSums {
            target: target.length(rows),
            residual: residual.length(rows),
            norms: norms.into_iter().map(|n| n.length(rows)).collect(),
            gradient,
            gram,
            target_dual: Ball {
                value: product,
                error: (product_error + rounding) * (1.0 + 1e-9),
            },
            dual_norm: dual.length(rows),
        })
    }
}
