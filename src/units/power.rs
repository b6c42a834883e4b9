//! Exponents of units: small fractions, exactly.
//!
//! In: whole numbers, fractions, floats that are one. Out: sums and products of them, or nothing beyond the limits.

/// Largest exponent and largest denominator; no law of physics comes near.
pub const MOST: i32 = 100;

/// A fraction in lowest terms, not zero in any unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Power {
    over: i32,
    /// At least 1.
    under: i32,
}

impl Power {
    pub const ONE: Power = Power { over: 1, under: 1 };

    /// `over/under`; `None` for a zero denominator or beyond `MOST`.
    pub fn new(over: i64, under: i64) -> Option<Power> {
        let divisor = gcd(over.unsigned_abs(), under.unsigned_abs());
        let divisor = i64::try_from(divisor).ok().filter(|d| *d > 0)? * under.signum();
        let (over, under) = (over.checked_div(divisor)?, under.checked_div(divisor)?);
        let most = i64::from(MOST);
        // |over/under| ≤ MOST, and both small enough to multiply without care.
        let fits = under >= 1 && under <= most && over.abs() <= most * under;
        fits.then_some(Power {
            over: over as i32,
            under: under as i32,
        })
    }

    /// The fraction that a float stands for: 0.5, 1.5, 0.3333333333333333.
    pub fn of(x: f64) -> Option<Power> {
        if x.is_nan() || x.abs() > f64::from(MOST) {
            return None;
        }
        (1..=MOST).find_map(|under| {
            let over = x * f64::from(under);
            let whole = over.round();
            let near = (over - whole).abs() <= 1e-12 * f64::from(MOST);
            near.then(|| Power::new(whole as i64, i64::from(under)))?
        })
    }

    pub fn plus(self, other: Power) -> Option<Power> {
        let (a, b) = (i64::from(self.over), i64::from(other.over));
        let (c, d) = (i64::from(self.under), i64::from(other.under));
        Power::new(a * d + b * c, c * d)
    }

    pub fn times(self, other: Power) -> Option<Power> {
        let over = i64::from(self.over) * i64::from(other.over);
        Power::new(over, i64::from(self.under) * i64::from(other.under))
    }

    pub fn negated(self) -> Power {
        Power {
            over: -self.over,
            under: self.under,
        }
    }

    pub fn is_zero(self) -> bool {
        self.over == 0
    }

    pub fn is_negative(self) -> bool {
        self.over < 0
    }

    pub fn value(self) -> f64 {
        f64::from(self.over) / f64::from(self.under)
    }
}

/// `2`, `0.5`, and `(1/3)` where decimals do not end.
impl std::fmt::Display for Power {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if 100 % self.under == 0 {
            write!(f, "{}", self.value())
        } else {
            write!(f, "({}/{})", self.over, self.under)
        }
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}
