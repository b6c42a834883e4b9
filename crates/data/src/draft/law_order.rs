//! The likely order of a state's law: first if the other signals explain its rate, else second.
//!
//! In: the columns of a state, of all signals and of time. Out: 1 or 2, and why. Least squares on products of the signals.

use nalgebra::{DMatrix, DVector};

use super::table_column::Column;
use super::thresholds::LAW_ORDER;
use crate::derivatives::difference_noise;

/// 1 if products of two signals and cubes explain the state's central differences, else 2; with the reason.
///
/// The differences span as many samples as the state needs to move visibly, so that noise does not decide.
pub(super) fn law_order(
    state: &Column,
    signals: &[&Column],
    time: Option<&Column>,
) -> (u8, &'static str) {
    const FEW: (u8, &str) = (1, "too few rows to guess its order");
    let n = state.values.len();
    let reach = reach(&state.values);
    if n < 2 * reach + LAW_ORDER.min_rows {
        return FEW;
    }
    let signals: Vec<Vec<f64>> = signals
        .iter()
        .take(LAW_ORDER.max_signals)
        .map(|c| scaled(&c.values))
        .collect();
    let stride = (n / LAW_ORDER.max_rows).max(1);
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
        return FEW;
    }
    let mean = rates.iter().sum::<f64>() / rates.len() as f64;
    let spread = rates.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
    let Some(left) = left_by_least_squares(&rows, rates) else {
        return FEW;
    };
    if left <= (1.0 - LAW_ORDER.explained) * spread {
        (1, "the signals explain its rate")
    } else {
        (2, "the signals do not explain its rate")
    }
}

/// ‖A x − y‖² at its least.
pub(super) fn left_by_least_squares(rows: &[Vec<f64>], y: Vec<f64>) -> Option<f64> {
    let wide = rows.first().map_or(0, Vec::len);
    let a = DMatrix::from_fn(rows.len(), wide, |i, j| rows[i][j]);
    let y = DVector::from_vec(y);
    let x = a
        .clone()
        .svd(true, true)
        .solve(&y, LAW_ORDER.rank_tolerance);
    Some((&a * x.ok()? - y).norm_squared())
}

/// Samples in which the state moves visibly, in the mean, and by more than the noise of a difference.
pub(super) fn reach(values: &[f64]) -> usize {
    let scaled = scaled(values);
    let noise = difference_noise(std::iter::once(&scaled[..]));
    let visible = LAW_ORDER.visible.max(LAW_ORDER.visible_noise * noise);
    let moved = |k: usize| {
        let steps = scaled
            .iter()
            .zip(scaled.iter().skip(k))
            .map(|(a, b)| (b - a).abs());
        let steps: Vec<f64> = steps.filter(|s| s.is_finite()).collect();
        steps.iter().sum::<f64>() / steps.len().max(1) as f64
    };
    let longest = scaled.len().saturating_sub(LAW_ORDER.min_rows) / 2;
    let reaches = [1, 2, 4, 8, 16, 32].into_iter();
    let mut reaches = reaches.filter(|k| *k <= longest.max(1)).peekable();
    let mut last = 1;
    while let Some(k) = reaches.next_if(|k| moved(2 * k) <= visible) {
        last = k;
    }
    reaches.next().unwrap_or(last)
}

/// Values less their mean, in standard deviations.
pub(super) fn scaled(values: &[f64]) -> Vec<f64> {
    let finite = || values.iter().filter(|v| v.is_finite());
    let n = finite().count().max(1) as f64;
    let mean = finite().sum::<f64>() / n;
    let spread = (finite().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    values
        .iter()
        .map(|v| (v - mean) / spread.max(f64::MIN_POSITIVE))
        .collect()
}

/// The constant, all products of up to two signals, and the cubes.
fn products(x: &[f64]) -> Vec<f64> {
    let mut out = vec![1.0];
    for (i, a) in x.iter().enumerate() {
        out.push(*a);
        out.push(a * a * a);
        out.extend(x.iter().skip(i).map(|b| a * b));
    }
    out
}
