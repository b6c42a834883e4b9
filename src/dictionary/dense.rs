//! Φ stored whole, column after column.

use super::{Collector, Dictionary, Strongest};

/// A column-major M × N matrix with its column norms.
#[derive(Clone, Debug)]
pub struct Dense {
    rows: usize,
    values: Vec<f64>,
    norms: Vec<f64>,
}

impl Dense {
    /// `values` holds the columns one after another; its length is a multiple of `rows`.
    pub fn new(rows: usize, values: Vec<f64>) -> Self {
        debug_assert!(rows > 0 && values.len().is_multiple_of(rows));
        let norms = values.chunks_exact(rows.max(1)).map(norm).collect();
        Dense {
            rows,
            values,
            norms,
        }
    }

    /// Column-major values, M · N of them.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

impl Dictionary for Dense {
    fn rows(&self) -> usize {
        self.rows
    }

    fn cols(&self) -> usize {
        self.norms.len()
    }

    fn norms(&self) -> &[f64] {
        &self.norms
    }

    fn column(&self, j: usize, out: &mut [f64]) {
        out.copy_from_slice(&self.values[j * self.rows..(j + 1) * self.rows]);
    }

    fn strongest(&self, lambda: &[f64], most: usize, least: f64) -> Strongest {
        let mut found = Collector::new(most, least);
        let columns = self.values.chunks_exact(self.rows).zip(&self.norms);
        for (j, (column, norm)) in columns.enumerate().filter(|(_, (_, n))| **n > 0.0) {
            found.offer(j, dot(column, lambda) / norm);
        }
        found.finish()
    }
}

/// Eight running sums, which the processor adds side by side; the order is fixed, so the result is too.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (heads, tails) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = heads
        .remainder()
        .iter()
        .zip(tails.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (a, b) in heads.zip(tails) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// Euclidean length without overflow for columns of any magnitude.
fn norm(column: &[f64]) -> f64 {
    let largest = column.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest
        * column
            .iter()
            .map(|x| (x / largest).powi(2))
            .sum::<f64>()
            .sqrt()
}
