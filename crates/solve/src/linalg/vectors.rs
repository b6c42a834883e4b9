//! Vectors: dot products, norms, differences.

use nalgebra::RealField;

/// aᵀb in `LANES` running sums, which the processor adds side by side. Their order is fixed, so the result is too.
#[inline(always)]
pub fn dot_in_lanes<const LANES: usize, T: RealField + Copy>(a: &[T], b: &[T]) -> T {
    let mut sums = [T::zero(); LANES];
    let (heads, tails) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = heads.remainder().iter().zip(tails.remainder());
    let rest = rest.fold(T::zero(), |sum, (a, b)| sum + *a * *b);
    for (a, b) in heads.zip(tails) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += *a * *b;
        }
    }
    sums.iter().fold(T::zero(), |sum, x| sum + *x) + rest
}

/// aᵀb/‖a‖ where aᵀb itself overflows; `norm` is ‖a‖.
pub fn scaled_dot(a: &[f64], norm: f64, b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a / norm * b).sum()
}

/// aᵀb/‖a‖; `norm` is ‖a‖. NaN if that is zero.
#[inline(always)]
pub fn correlation<const LANES: usize>(a: &[f64], norm: f64, b: &[f64]) -> f64 {
    let product = dot_in_lanes::<LANES, f64>(a, b);
    if product.is_finite() {
        product / norm
    } else {
        scaled_dot(a, norm, b)
    }
}

/// Whether a sum of squares, or a norm, is exact to rounding: nothing underflowed that matters, nothing overflowed. NaN is not.
#[inline(always)]
pub fn is_safe(sum: f64) -> bool {
    (1e-280..=1e280).contains(&sum)
}

/// ‖v‖₂ without overflow; not finite if an entry is not.
pub fn norm(v: &[f64]) -> f64 {
    let largest = largest_magnitude(v);
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let squares: f64 = v.iter().map(|x| (x / largest).powi(2)).sum();
    largest * squares.sqrt()
}

/// ‖v‖₂, given the sum of its squares; computed anew where that under- or overflowed.
pub fn norm_from_squares(squares: f64, v: &[f64]) -> f64 {
    if is_safe(squares) {
        squares.sqrt()
    } else {
        norm(v)
    }
}

/// max |v_i|; NaN if an entry is NaN.
pub fn largest_magnitude(v: &[f64]) -> f64 {
    if v.iter().any(|x| x.is_nan()) {
        return f64::NAN;
    }
    v.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// a − b
pub fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// v/c
pub fn quotient(v: &[f64], c: f64) -> Vec<f64> {
    v.iter().map(|x| x / c).collect()
}

/// The value itself where it is positive, otherwise one: a safe divisor.
pub fn nonzero(x: f64) -> f64 {
    if x > 0.0 { x } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn norms_of_any_magnitude() {
        for size in [1e-300, 1e-160, 1.0, 1e160, 1e300] {
            let found = norm(&[3.0 * size, -4.0 * size]);
            assert!((found / (5.0 * size) - 1.0).abs() < 1e-15, "{size}");
        }
        assert_eq!(norm(&[0.0, 0.0]), 0.0);
        assert!(norm(&[1.0, f64::NAN]).is_nan() && norm(&[f64::NAN; 2]).is_nan());
        assert_eq!(norm(&[1.0, f64::NEG_INFINITY]), f64::INFINITY);
    }

    #[test]
    fn dot_products_have_remainders() {
        let a: Vec<f64> = (1..=11).map(f64::from).collect();
        assert_eq!(dot_in_lanes::<8, f64>(&a, &a), 506.0);
    }
}
