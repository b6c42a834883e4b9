//! The rows of one equation, and sums over them in 106 bits: what it leaves, how long its columns are, how they stand to each other.
//!
//! In: samples, which rows, their weights; terms with coefficients. Out: [`Sums`]. Goes through the rows once and keeps none.

use super::double::{Double, ROUNDING};
use super::value::{self, Bounded};
use sidc_data::Samples;
use sidc_lang::term::{Signal, Term};

/// Rows of samples with their weights.
pub struct Rows<'a> {
    samples: &'a Samples,
    used: &'a [usize],
    weights: &'a [f64],
}

/// What is summed: y is the target less the known terms, r = y − Σ a φ.
pub struct Asked<'a> {
    pub target: Signal,
    pub known: &'a [(&'a Term, f64)],
    pub found: &'a [(&'a Term, f64)],
    /// One number a row; none if nothing is asked of it.
    pub dual: &'a [f64],
    /// Whether products of the columns with each other are wanted.
    pub gram: bool,
}

/// Sums over weighted rows.
pub struct Sums {
    /// ‖y‖
    pub target: Bounded,
    /// ‖r‖
    pub left: Bounded,
    /// ‖φ_j‖ of each term found.
    pub norms: Vec<Bounded>,
    /// φ_jᵀr
    pub slopes: Vec<Double>,
    /// φ_jᵀφ_l for l ≤ j, row after row; empty if not asked for.
    pub gram: Vec<Double>,
    /// yᵀλ and ‖λ‖
    pub price: Bounded,
    pub dual: Bounded,
}

/// A sum of squares or products with the squares of its summands' errors.
#[derive(Clone, Copy, Default)]
struct Running {
    sum: Double,
    error_square: f64,
}

impl Running {
    fn add_square(&mut self, x: Bounded) {
        self.sum = self.sum + x.value * x.value;
        self.error_square += x.error * x.error;
    }

    /// The root of a sum of squares: a length.
    fn length(self, rows: usize) -> Bounded {
        let value = self.sum.sqrt();
        let rounding = (rows as f64 + 4.0) * ROUNDING * value.hi;
        // Squares under the range of f64.
        let lost = (rows as f64).sqrt() * 1e-161;
        let error = self.error_square.sqrt() * (1.0 + 1e-9) + rounding + lost;
        match value.is_finite() && error.is_finite() {
            true => Bounded { value, error },
            false => Bounded {
                value,
                error: f64::INFINITY,
            },
        }
    }
}

impl<'a> Rows<'a> {
    /// `None` if a row is not there, or has no weight of its own.
    pub fn new(samples: &'a Samples, used: &'a [usize], weights: &'a [f64]) -> Option<Rows<'a>> {
        let there = used.iter().all(|r| *r < samples.len()) && used.is_sorted_by(|a, b| a < b);
        let weighted =
            weights.len() == used.len() && weights.iter().all(|w| *w >= 0.0 && w.is_finite());
        (there && weighted).then_some(Rows {
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

    /// Goes through the rows; `None` if `go_on` ended it.
    pub fn sums(&self, asked: &Asked, go_on: &mut dyn FnMut() -> bool) -> Option<Sums> {
        const BETWEEN: usize = 256;
        let k = asked.found.len();
        let (mut target, mut left, mut dual) =
            (Running::default(), Running::default(), Running::default());
        let mut norms = vec![Running::default(); k];
        let mut slopes = vec![Double::ZERO; k];
        let mut gram = vec![Double::ZERO; if asked.gram { k * (k + 1) / 2 } else { 0 }];
        let (mut price, mut price_error, mut price_size) = (Double::ZERO, 0.0, 0.0);
        let mut values = vec![Bounded::default(); k];
        for row in 0..self.len() {
            if row % BETWEEN == 0 && !go_on() {
                return None;
            }
            let (at, weight) = (self.at(row), self.weight(row));
            let mut y = Bounded::exact(at(asked.target));
            for (term, a) in asked.known {
                y = y.add(value::term(term, &at).scale(*a).negative());
            }
            let y = y.scale(weight);
            let mut r = y;
            for ((term, a), v) in asked.found.iter().zip(&mut values) {
                *v = value::term(term, &at).scale(weight);
                r = r.add(v.scale(*a).negative());
            }
            target.add_square(y);
            left.add_square(r);
            for (j, v) in values.iter().enumerate() {
                norms[j].add_square(*v);
                slopes[j] = slopes[j] + v.value * r.value;
            }
            if asked.gram {
                let pairs = (0..k).flat_map(|j| (0..=j).map(move |l| (j, l)));
                for (sum, (j, l)) in gram.iter_mut().zip(pairs) {
                    *sum = *sum + values[j].value * values[l].value;
                }
            }
            if let Some(lambda) = asked.dual.get(row) {
                dual.add_square(Bounded::exact(*lambda));
                let part = y.value * *lambda;
                price = price + part;
                price_error += y.error * lambda.abs();
                price_size += part.hi.abs();
            }
        }
        let rows = self.len();
        let rounding = 2.0 * (rows as f64 + 4.0) * ROUNDING * price_size;
        Some(Sums {
            target: target.length(rows),
            left: left.length(rows),
            norms: norms.into_iter().map(|n| n.length(rows)).collect(),
            slopes,
            gram,
            price: Bounded {
                value: price,
                error: (price_error + rounding) * (1.0 + 1e-9),
            },
            dual: dual.length(rows),
        })
    }
}
