//! Double-double arithmetic: a number of some 106 bits is an unevaluated sum of two f64.
//!
//! In: f64. Out: the same arithmetic with about 31 digits. The relative error of every operation is below [`ROUNDING`] (Joldes, Muller &
//! Popescu 2017, "Tight and rigorous error bounds for basic building blocks of double-word arithmetic"), as long as nothing
//! overflows or falls below 1e-290. Knows no equations.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Relative error of one operation: 2⁻¹⁰² = 16 · 2⁻¹⁰⁶. The proven bounds are at most 15 · 2⁻¹⁰⁶.
pub const ROUNDING: f64 = 1.0 / (1_u128 << 102) as f64;

/// hi + lo, with |lo| at most half a unit in the last place of hi.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble {
    pub hi: f64,
    pub lo: f64,
}

/// a + b without error, as the rounded sum and its rounding error (Knuth).
#[inline(always)]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The same for |a| ≥ |b| (Dekker).
#[inline(always)]
fn fast_two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    DoubleDouble {
        hi,
        lo: b - (hi - a),
    }
}

/// a · b without error, as the rounded product and its rounding error.
#[inline(always)]
pub fn two_prod(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

impl DoubleDouble {
    pub const ZERO: DoubleDouble = DoubleDouble { hi: 0.0, lo: 0.0 };
    pub const ONE: DoubleDouble = DoubleDouble { hi: 1.0, lo: 0.0 };

    /// The sum of two f64 of any size.
    pub fn sum(a: f64, b: f64) -> DoubleDouble {
        let (hi, lo) = two_sum(a, b);
        DoubleDouble { hi, lo }
    }

    /// The product of two f64.
    #[cfg(test)]
    pub fn product(a: f64, b: f64) -> DoubleDouble {
        let (hi, lo) = two_prod(a, b);
        DoubleDouble { hi, lo }
    }

    pub fn abs(self) -> DoubleDouble {
        if self.hi < 0.0 { -self } else { self }
    }

    /// √x; NaN below zero.
    pub fn sqrt(self) -> DoubleDouble {
        let root = self.hi.sqrt();
        if root == 0.0 || !root.is_finite() {
            return DoubleDouble::from(root);
        }
        let left = (-root).mul_add(root, self.hi) + self.lo;
        fast_two_sum(root, left / (2.0 * root))
    }

    /// x · 2ᵏ, k up to some 2000 either way.
    pub fn scaled(self, k: i32) -> DoubleDouble {
        let (first, second) = (2f64.powi(k / 2), 2f64.powi(k - k / 2));
        DoubleDouble {
            hi: self.hi * first * second,
            lo: self.lo * first * second,
        }
    }

    pub fn is_finite(self) -> bool {
        self.hi.is_finite() && self.lo.is_finite()
    }

    /// The nearest f64.
    pub fn to_f64(self) -> f64 {
        self.hi + self.lo
    }
}

impl From<f64> for DoubleDouble {
    fn from(x: f64) -> DoubleDouble {
        DoubleDouble { hi: x, lo: 0.0 }
    }
}

impl Neg for DoubleDouble {
    type Output = DoubleDouble;

    fn neg(self) -> DoubleDouble {
        DoubleDouble {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl Add for DoubleDouble {
    type Output = DoubleDouble;

    fn add(self, other: DoubleDouble) -> DoubleDouble {
        let (s, s_left) = two_sum(self.hi, other.hi);
        let (t, t_left) = two_sum(self.lo, other.lo);
        let first = fast_two_sum(s, s_left + t);
        fast_two_sum(first.hi, t_left + first.lo)
    }
}

impl Sub for DoubleDouble {
    type Output = DoubleDouble;

    fn sub(self, other: DoubleDouble) -> DoubleDouble {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = DoubleDouble;

    fn mul(self, other: DoubleDouble) -> DoubleDouble {
        let (product, left) = two_prod(self.hi, other.hi);
        let cross = self.hi.mul_add(other.lo, self.lo * other.lo);
        let cross = self.lo.mul_add(other.hi, cross);
        fast_two_sum(product, left + cross)
    }
}

impl Mul<f64> for DoubleDouble {
    type Output = DoubleDouble;

    fn mul(self, other: f64) -> DoubleDouble {
        let (product, left) = two_prod(self.hi, other);
        fast_two_sum(product, self.lo.mul_add(other, left))
    }
}

impl Div for DoubleDouble {
    type Output = DoubleDouble;

    fn div(self, other: DoubleDouble) -> DoubleDouble {
        let first = self.hi / other.hi;
        let left = self - other * first;
        fast_two_sum(first, left.hi / other.hi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn third() -> DoubleDouble {
        DoubleDouble::ONE / DoubleDouble::from(3.0)
    }

    #[test]
    fn digits_are_twice_those_of_f64() {
        let off = (third() * 3.0 - DoubleDouble::ONE).abs().to_f64();
        assert!(off < 4.0 * ROUNDING, "{off:e}");
        let root = DoubleDouble::from(2.0).sqrt();
        let off = (root * root - DoubleDouble::from(2.0)).abs().to_f64();
        assert!(off < 4.0 * ROUNDING, "{off:e}");
        assert_eq!(root.hi, 2f64.sqrt());
        // 1 + 2⁻⁸⁰ − 1
        let tiny = 2f64.powi(-80);
        let kept = DoubleDouble::sum(1.0, tiny) - DoubleDouble::ONE;
        assert_eq!(kept.to_f64(), tiny);
    }

    #[test]
    fn sums_and_products_of_f64_are_exact() {
        let (a, b) = (1.0 + 2f64.powi(-40), 1.0 - 2f64.powi(-41));
        let exact = DoubleDouble::product(a, b);
        // (1 + x)(1 − x/2) = 1 + x/2 − x²/2 for x = 2⁻⁴⁰
        let parts = [1.0, 2f64.powi(-41), -2f64.powi(-81)];
        let sum = parts
            .iter()
            .fold(DoubleDouble::ZERO, |s, p| s + DoubleDouble::from(*p));
        assert_eq!(exact, sum);
        assert_eq!(
            DoubleDouble::sum(1e16, 1.0) - DoubleDouble::from(1e16),
            DoubleDouble::ONE
        );
    }

    #[test]
    fn values_that_are_not_finite_stay_so() {
        let huge = DoubleDouble::from(1e300) * DoubleDouble::from(1e300);
        assert!(!huge.is_finite());
        assert!(!DoubleDouble::from(-1.0).sqrt().is_finite());
        assert!(!(DoubleDouble::ONE / DoubleDouble::ZERO).is_finite());
        assert_eq!(DoubleDouble::ONE.scaled(-1070).to_f64(), 2f64.powi(-1070));
    }
}
