//! A polynomial through a few readings: a first guess of a value or a rate.
//!
//! In: instants and readings, NaN where missing. Out: the value or a derivative at an instant. Knows no equations.

use nalgebra::{DMatrix, DVector};

/// The derivative of order `der` at `at` of the least-squares polynomial, one degree above `der` where there are enough readings;
/// `None` if there are fewer than `der + 1`.
pub(super) fn local_derivative(time: &[f64], values: &[f64], at: f64, der: usize) -> Option<f64> {
    let pairs = time.iter().zip(values);
    let pairs: Vec<(f64, f64)> = pairs
        .filter(|(_, v)| v.is_finite())
        .map(|(t, v)| (t - at, *v))
        .collect();
    let degree = (der + 1).min(pairs.len().checked_sub(1)?);
    if degree < der {
        return None;
    }
    let scale = pairs.iter().fold(0.0, |m: f64, (t, _)| m.max(t.abs()));
    let scale = if scale > 0.0 { scale } else { 1.0 };
    let power = |(t, _): &(f64, f64), j: usize| (t / scale).powi(j as i32);
    let design = DMatrix::from_fn(pairs.len(), degree + 1, |i, j| power(&pairs[i], j));
    let right = DVector::from_iterator(pairs.len(), pairs.iter().map(|p| p.1));
    let fitted = design.svd(true, true).solve(&right, 1e-12).ok()?;
    let factorial: f64 = (1..=der).map(|k| k as f64).product();
    let value = fitted.get(der)? * factorial / scale.powi(der as i32);
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_met_with_its_slope() {
        let time = [0.0, 0.1, 0.2, 0.3, 0.4];
        let values = time.map(|t| 1.0 + 2.0 * t - 3.0 * t * t);
        let slope = local_derivative(&time, &values, 0.1, 1).unwrap();
        assert!((slope - 1.4).abs() < 1e-12);
        let gappy = [1.0, f64::NAN, values[2], values[3], f64::NAN];
        assert!((local_derivative(&time, &gappy, 0.0, 1).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(local_derivative(&time, &[f64::NAN; 5], 0.0, 0), None);
    }
}
