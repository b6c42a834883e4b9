//! Numbers of some 106 bits: an unevaluated sum of two f64.
//!
//! In: f64. Out: the same arithmetic with about 31 digits. Every operation here is off by less than [`ROUNDING`] of its result (Joldes, Muller &
//! Popescu 2017, "Tight and rigorous error bounds for basic building blocks of double-word arithmetic"), as long as nothing
//! overflows or falls under 1e-290. Knows no equations.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Relative error of one operation: 2⁻¹⁰². The proven bounds are at most 15 · 2⁻¹⁰⁶.
pub const ROUNDING: f64 = 1.0 / (1_u128 << 102) as f64;

/// hi + lo, with |lo| at most half a unit in the last place of hi.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Double {
    pub hi: f64,
    pub lo: f64,
}

/// a + b without error, as rounded sum and what rounding took (Knuth).
#[inline(always)]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The same for |a| ≥ |b| (Dekker).
#[inline(always)]
fn fast_two_sum(a: f64, b: f64) -> Double {
    let hi = a + b;
    Double {
        hi,
        lo: b - (hi - a),
    }
}

/// a · b without error, as rounded product and what rounding took.
#[inline(always)]
pub fn two_prod(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

impl Double {
    pub const ZERO: Double = Double { hi: 0.0, lo: 0.0 };
    pub const ONE: Double = Double { hi: 1.0, lo: 0.0 };

    /// The sum of two f64 of any size.
    pub fn sum(a: f64, b: f64) -> Double {
        let (hi, lo) = two_sum(a, b);
        Double { hi, lo }
    }

    /// The product of two f64.
    #[cfg(test)]
    pub fn product(a: f64, b: f64) -> Double {
        let (hi, lo) = two_prod(a, b);
        Double { hi, lo }
    }

    pub fn abs(self) -> Double {
        if self.hi < 0.0 { -self } else { self }
    }

    /// √x; NaN below zero.
    pub fn sqrt(self) -> Double {
        let root = self.hi.sqrt();
        if root == 0.0 || !root.is_finite() {
            return Double::from(root);
        }
        let left = (-root).mul_add(root, self.hi) + self.lo;
        fast_two_sum(root, left / (2.0 * root))
    }

    /// x · 2ᵏ, k up to some 2000 either way.
    pub fn scaled(self, k: i32) -> Double {
        let (first, second) = (2f64.powi(k / 2), 2f64.powi(k - k / 2));
        Double {
            hi: self.hi * first * second,
            lo: self.lo * first * second,
        }
    }

    pub fn is_finite(self) -> bool {
        self.hi.is_finite() && self.lo.is_finite()
    }

    /// The nearest f64.
    pub fn value(self) -> f64 {
        self.hi + self.lo
    }
}

impl From<f64> for Double {
    fn from(x: f64) -> Double {
        Double { hi: x, lo: 0.0 }
    }
}

impl Neg for Double {
    type Output = Double;

    fn neg(self) -> Double {
        Double {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl Add for Double {
    type Output = Double;

    fn add(self, other: Double) -> Double {
        let (s, s_left) = two_sum(self.hi, other.hi);
        let (t, t_left) = two_sum(self.lo, other.lo);
        let first = fast_two_sum(s, s_left + t);
        fast_two_sum(first.hi, t_left + first.lo)
    }
}

impl Sub for Double {
    type Output = Double;

    fn sub(self, other: Double) -> Double {
        self + -other
    }
}

impl Mul for Double {
    type Output = Double;

    fn mul(self, other: Double) -> Double {
        let (product, left) = two_prod(self.hi, other.hi);
        let cross = self.hi.mul_add(other.lo, self.lo * other.lo);
        let cross = self.lo.mul_add(other.hi, cross);
        fast_two_sum(product, left + cross)
    }
}

impl Mul<f64> for Double {
    type Output = Double;

    fn mul(self, other: f64) -> Double {
        let (product, left) = two_prod(self.hi, other);
        fast_two_sum(product, self.lo.mul_add(other, left))
    }
}

impl Div for Double {
    type Output = Double;

    fn div(self, other: Double) -> Double {
        let first = self.hi / other.hi;
        let left = self - other * first;
        fast_two_sum(first, left.hi / other.hi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn third() -> Double {
        Double::ONE / Double::from(3.0)
    }

    #[test]
    fn digits_are_twice_those_of_f64() {
        let off = (third() * 3.0 - Double::ONE).abs().value();
        assert!(off < 4.0 * ROUNDING, "{off:e}");
        let root = Double::from(2.0).sqrt();
        let off = (root * root - Double::from(2.0)).abs().value();
        assert!(off < 4.0 * ROUNDING, "{off:e}");
        assert_eq!(root.hi, 2f64.sqrt());
        // 1 + 2⁻⁸⁰ − 1
        let tiny = 2f64.powi(-80);
        let kept = Double::sum(1.0, tiny) - Double::ONE;
        assert_eq!(kept.value(), tiny);
    }

    #[test]
    fn sums_and_products_of_f64_are_exact() {
        let (a, b) = (1.0 + 2f64.powi(-40), 1.0 - 2f64.powi(-41));
        let exact = Double::product(a, b);
        // (1 + x)(1 − x/2) = 1 + x/2 − x²/2 for x = 2⁻⁴⁰
        let parts = [1.0, 2f64.powi(-41), -2f64.powi(-81)];
        let sum = parts.iter().fold(Double::ZERO, |s, p| s + Double::from(*p));
        assert_eq!(exact, sum);
        assert_eq!(Double::sum(1e16, 1.0) - Double::from(1e16), Double::ONE);
    }

    #[test]
    fn what_is_not_finite_stays_so() {
        let huge = Double::from(1e300) * Double::from(1e300);
        assert!(!huge.is_finite());
        assert!(!Double::from(-1.0).sqrt().is_finite());
        assert!(!(Double::ONE / Double::ZERO).is_finite());
        assert_eq!(Double::ONE.scaled(-1070).value(), 2f64.powi(-1070));
    }
}
