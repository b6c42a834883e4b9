//! Of which order a state's law is likely to be: whether the other states and inputs give its rate.

use nalgebra::{DMatrix, DVector};

use super::column::Column;

/// Rows looked at.
const ROWS: usize = 1500;
/// Signals whose products are tried.
const SIGNALS: usize = 8;
/// Part of a rate that is explained if the law is of first order.
const EXPLAINED: f64 = 0.8;

/// 1 if products of up to three of the signals explain the state's differences, else 2. The differences reach as far as it
/// takes the state to move visibly, so that noise does not decide.
pub(super) fn order(state: &Column, signals: &[&Column], time: Option<&Column>) -> u8 {
    let n = state.values.len();
    let reach = reach(&state.values);
    if n < 2 * reach + 30 {
        return 1;
    }
    let signals: Vec<Vec<f64>> = signals
        .iter()
        .take(SIGNALS)
        .map(|c| scaled(&c.values))
        .collect();
    let stride = (n / ROWS).max(1);
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut rates = Vec::new();
    for k in (reach..n - reach).step_by(stride) {
        let at = |v: &[f64], i: usize| v.get(i).copied().unwrap_or(f64::NAN);
        let dt = time.map_or(1.0, |t| at(&t.values, k + reach) - at(&t.values, k - reach));
        let rate = (at(&state.values, k + reach) - at(&state.values, k - reach)) / dt;
        let row = products(&signals.iter().map(|v| at(v, k)).collect::<Vec<f64>>());
        if dt > 0.0 && rate.is_finite() && row.iter().all(|v| v.is_finite()) {
            rates.push(rate);
            rows.push(row);
        }
    }
    let wide = rows.first().map_or(0, Vec::len);
    if wide == 0 || rows.len() < 2 * wide {
        return 1;
    }
    let a = DMatrix::from_fn(rows.len(), wide, |i, j| rows[i][j]);
    let y = DVector::from_vec(rates);
    let mean = y.mean();
    let spread = y.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
    let Ok(x) = a.clone().svd(true, true).solve(&y, 1e-9) else {
        return 1;
    };
    let left = (&a * x - &y).norm_squared();
    if left <= (1.0 - EXPLAINED) * spread {
        1
    } else {
        2
    }
}

/// Samples over which the state moves by a twentieth of its spread, in the mean.
fn reach(values: &[f64]) -> usize {
    let scaled = scaled(values);
    let moved = |k: usize| {
        let steps = scaled
            .iter()
            .zip(scaled.iter().skip(k))
            .map(|(a, b)| (b - a).abs());
        let steps: Vec<f64> = steps.filter(|s| s.is_finite()).collect();
        steps.iter().sum::<f64>() / steps.len().max(1) as f64
    };
    let reaches = [1, 2, 4, 8, 16];
    reaches
        .into_iter()
        .find(|k| moved(2 * k) > 0.05)
        .unwrap_or(16)
}

/// About their mean, in standard deviations.
fn scaled(values: &[f64]) -> Vec<f64> {
    let finite = || values.iter().filter(|v| v.is_finite());
    let n = finite().count().max(1) as f64;
    let mean = finite().sum::<f64>() / n;
    let spread = (finite().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    values
        .iter()
        .map(|v| (v - mean) / spread.max(f64::MIN_POSITIVE))
        .collect()
}

/// All products of up to two signals, and the cubes.
fn products(x: &[f64]) -> Vec<f64> {
    let mut out = vec![1.0];
    for (i, a) in x.iter().enumerate() {
        out.push(*a);
        out.push(a * a * a);
        out.extend(x.iter().skip(i).map(|b| a * b));
    }
    out
}
