//! Generalised least squares on a record whose errors are white noise on a random walk.
//!
//! In: columns along stretches of time. Out: sums of products of the whitened columns, in ten parts of the record, for one ratio of the two
//! variances. The filter is Kalman's for the local level model (Harvey 1989, Forecasting, Structural Time Series Models, ch. 2).

use super::thresholds::RATES;

/// Columns of one stretch: the accumulated difference by two quadratures, then what may explain it.
pub(super) const COLUMNS: usize = 7;

/// One row of all columns. `walked`: the variance that the random walk gained since the row before, relative to its mean gain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub values: [f64; COLUMNS],
    pub walked: f64,
}

/// Sums of products of columns over one part of the record.
pub(super) type Products = [[f64; COLUMNS]; COLUMNS];

/// Whitened columns as sums of products.
#[derive(Clone, Debug)]
pub(super) struct Whitened {
    pub parts: Vec<Products>,
    pub rows: usize,
    /// Sum of the logarithms of the variances that were divided by.
    pub log_variance: f64,
}

/// Whitens stretches for a random walk whose steps have `ratio` times the variance of the white noise. The unknown level at the start of
/// each stretch takes its first row.
pub(super) fn whiten(stretches: &[Vec<Row>], ratio: f64) -> Whitened {
    let rows = stretches.iter().map(|s| s.len().saturating_sub(1)).sum();
    let mut out = Whitened {
        parts: vec![[[0.0; COLUMNS]; COLUMNS]; RATES.parts],
        rows,
        log_variance: 0.0,
    };
    let mut at = 0;
    for stretch in stretches {
        let Some(first) = stretch.first() else {
            continue;
        };
        let (mut level, mut variance) = (first.values, 1.0);
        for row in &stretch[1..] {
            variance += ratio * row.walked;
            let total = variance + 1.0;
            let (gain, scale) = (variance / total, total.sqrt().recip());
            let mut innovation = [0.0; COLUMNS];
            for ((level, value), v) in level.iter_mut().zip(row.values).zip(&mut innovation) {
                *v = scale * (value - *level);
                *level += gain * (value - *level);
            }
            variance *= 1.0 - gain;
            out.log_variance += total.ln();
            add(&mut out.parts[at * RATES.parts / rows.max(1)], &innovation);
            at += 1;
        }
    }
    out
}

fn add(products: &mut Products, row: &[f64; COLUMNS]) {
    for (line, x) in products.iter_mut().zip(row) {
        for (entry, y) in line.iter_mut().zip(row) {
            *entry += x * y;
        }
    }
}

impl Whitened {
    /// Sums over the whole record.
    pub(super) fn sum(&self) -> Products {
        let mut out = [[0.0; COLUMNS]; COLUMNS];
        for part in &self.parts {
            for (line, own) in out.iter_mut().zip(part) {
                line.iter_mut().zip(own).for_each(|(x, y)| *x += y);
            }
        }
        out
    }
}
