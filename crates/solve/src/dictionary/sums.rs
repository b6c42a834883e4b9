//! Sums over columns: dot products and lengths.

/// Eight running sums, which the processor adds side by side; the order is fixed, so the result is too.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
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

/// aᵀb/‖a‖ where aᵀb is beyond what a number can be; the length is that of a.
pub fn scaled_dot(a: &[f64], length: f64, b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a / length * b).sum()
}

/// Whether a sum of squares, or a length, is exact to rounding: nothing that matters was lost to underflow, nothing
/// overflowed. NaN is not.
#[inline]
pub fn is_safe(sum: f64) -> bool {
    (1e-280..=1e280).contains(&sum)
}

/// Euclidean length without overflow for columns of any magnitude; not finite if an entry is not.
pub fn length(column: &[f64]) -> f64 {
    let largest = largest(column);
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let squares: f64 = column.iter().map(|x| (x / largest).powi(2)).sum();
    largest * squares.sqrt()
}

/// The largest magnitude; NaN if there is one.
pub fn largest(column: &[f64]) -> f64 {
    if column.iter().any(|x| x.is_nan()) {
        return f64::NAN;
    }
    column.iter().fold(0.0, |m, x| m.max(x.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_of_any_magnitude() {
        for size in [1e-300, 1e-160, 1.0, 1e160, 1e300] {
            let found = length(&[3.0 * size, -4.0 * size]);
            assert!((found / (5.0 * size) - 1.0).abs() < 1e-15, "{size}");
        }
        assert_eq!(length(&[0.0, 0.0]), 0.0);
        assert!(length(&[1.0, f64::NAN]).is_nan() && length(&[f64::NAN; 2]).is_nan());
        assert_eq!(length(&[1.0, f64::NEG_INFINITY]), f64::INFINITY);
    }

    #[test]
    fn dot_products_have_remainders() {
        let a: Vec<f64> = (1..=11).map(f64::from).collect();
        assert_eq!(dot(&a, &a), 506.0);
    }
}
