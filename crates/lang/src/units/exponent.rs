//! Exponents of units: small fractions, exactly.
//!
//! In: integers, fractions, floats that stand for one. Out: their sums and products, or nothing beyond the limits. Never rounds.

use crate::thresholds::UNITS;

/// A fraction in lowest terms. Units drop symbols with exponent 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Exponent {
    numerator: i32,
    /// At least 1.
    denominator: i32,
}

impl Exponent {
    pub const ONE: Exponent = Exponent {
        numerator: 1,
        denominator: 1,
    };

    /// `numerator/denominator`; `None` for a zero denominator or beyond the limits of the family `UNITS`.
    pub fn new(numerator: i64, denominator: i64) -> Option<Exponent> {
        let divisor = gcd(numerator.unsigned_abs(), denominator.unsigned_abs());
        let divisor = i64::try_from(divisor).ok().filter(|d| *d > 0)? * denominator.signum();
        let (numerator, denominator) = (
            numerator.checked_div(divisor)?,
            denominator.checked_div(divisor)?,
        );
        let most = i64::from(UNITS.exponent);
        // Bounds the fraction and its denominator, so that products of two fractions fit 64 bits.
        let fits = denominator >= 1 && denominator <= most && numerator.abs() <= most * denominator;
        fits.then_some(Exponent {
            numerator: numerator as i32,
            denominator: denominator as i32,
        })
    }

    /// The fraction of smallest denominator that a float stands for: 0.5, 1.5, 0.3333333333333333.
    pub fn nearest(x: f64) -> Option<Exponent> {
        if x.is_nan() || x.abs() > f64::from(UNITS.exponent) {
            return None;
        }
        (1..=UNITS.exponent).find_map(|denominator| {
            let numerator = x * f64::from(denominator);
            let whole = numerator.round();
            let near = (numerator - whole).abs() <= UNITS.fraction * f64::from(UNITS.exponent);
            near.then(|| Exponent::new(whole as i64, i64::from(denominator)))?
        })
    }

    pub fn plus(self, other: Exponent) -> Option<Exponent> {
        let (a, b) = (i64::from(self.numerator), i64::from(other.numerator));
        let (c, d) = (i64::from(self.denominator), i64::from(other.denominator));
        Exponent::new(a * d + b * c, c * d)
    }

    pub fn times(self, other: Exponent) -> Option<Exponent> {
        let numerator = i64::from(self.numerator) * i64::from(other.numerator);
        Exponent::new(
            numerator,
            i64::from(self.denominator) * i64::from(other.denominator),
        )
    }

    pub fn negated(self) -> Exponent {
        Exponent {
            numerator: -self.numerator,
            denominator: self.denominator,
        }
    }

    pub fn is_zero(self) -> bool {
        self.numerator == 0
    }

    pub fn is_negative(self) -> bool {
        self.numerator < 0
    }

    pub fn value(self) -> f64 {
        f64::from(self.numerator) / f64::from(self.denominator)
    }
}

/// `2`, `0.5`, and `(1/3)` if two decimals are not enough.
impl std::fmt::Display for Exponent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if 100 % self.denominator == 0 {
            write!(f, "{}", self.value())
        } else {
            write!(f, "({}/{})", self.numerator, self.denominator)
        }
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}
