//! Ball arithmetic: numbers in 106 bits, each with a bound on its error.
//!
//! In: balls. Out: the ball that surely holds the result: errors are propagated to first order, times two. The functions are defined
//! here a second time, apart from the table that the rest of the program uses. A function that is unknown here has no bound.

use super::double_double::{DoubleDouble, ROUNDING};
use super::elementary_functions::{ACCURACY, acos, asin, atan, exp, log, sin_cos, sinh_cosh, tanh};
use super::thresholds::ARITHMETIC;

/// The numbers that differ from `value` by at most `error`; all numbers if that is not finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ball {
    pub value: DoubleDouble,
    pub error: f64,
}

impl Ball {
    pub fn exact(x: f64) -> Ball {
        Ball {
            value: DoubleDouble::from(x),
            error: 0.0,
        }
    }

    pub const ONE: Ball = Ball {
        value: DoubleDouble::ONE,
        error: 0.0,
    };

    /// The result of an operation: `error` comes from its arguments, `rounding` from the operation itself.
    fn with(value: DoubleDouble, error: f64, rounding: f64) -> Ball {
        if !value.is_finite() {
            return Ball {
                value,
                error: f64::INFINITY,
            };
        }
        // The bounds themselves are rounded.
        Ball {
            value,
            error: (error + rounding) * (1.0 + 1e-12),
        }
    }

    pub fn size(self) -> f64 {
        self.value.hi.abs()
    }

    /// Upper bound of all sizes in the ball.
    pub fn upper(self) -> f64 {
        (self.value.to_f64().abs() + self.error) * (1.0 + f64::EPSILON)
    }

    /// Lower bound of all sizes in the ball.
    pub fn lower(self) -> f64 {
        ((self.value.to_f64().abs() - self.error) * (1.0 - f64::EPSILON)).max(0.0)
    }

    pub fn add(self, other: Ball) -> Ball {
        let value = self.value + other.value;
        Ball::with(value, self.error + other.error, ROUNDING * value.hi.abs())
    }

    pub fn negative(self) -> Ball {
        Ball {
            value: -self.value,
            error: self.error,
        }
    }

    pub fn times(self, other: Ball) -> Ball {
        let value = self.value * other.value;
        let crossed = self.size() * other.error + other.size() * self.error;
        Ball::with(
            value,
            2.0 * crossed + self.error * other.error,
            rounded(value, self.size() > 0.0 && other.size() > 0.0),
        )
    }

    pub fn scale(self, k: f64) -> Ball {
        // A factor of ±1 adds no error: 1 − cos x is then exactly zero at x = 0.
        match k {
            1.0 => self,
            -1.0 => self.negative(),
            k => self.times(Ball::exact(k)),
        }
    }

    pub fn over(self, other: Ball) -> Ball {
        let value = self.value / other.value;
        let below = other.lower();
        let error = (self.error + value.hi.abs() * other.error) / below;
        Ball::with(value, 2.0 * error, rounded(value, self.size() > 0.0))
    }

    pub fn sqrt(self) -> Ball {
        let value = self.value.sqrt();
        // |√a − √b| ≤ |a − b|/√a, and never more than √|a − b|.
        let error = match self.error {
            0.0 => 0.0,
            e => (e / value.hi).min(e.sqrt()),
        };
        Ball::with(value, 2.0 * error, ROUNDING * value.hi)
    }

    /// xᵖ, as the language defines it.
    pub fn power(self, p: f64) -> Ball {
        if p == 0.5 {
            return self.sqrt();
        }
        if p.fract() == 0.0 && p.abs() <= 1024.0 {
            let whole = self.whole_power(p.abs() as u32);
            return if p < 0.0 {
                Ball::ONE.over(whole)
            } else {
                whole
            };
        }
        if self.value.hi == 0.0 && self.error == 0.0 && p > 0.0 {
            return self;
        }
        if self.value.hi < 0.0 && p.fract() != 0.0 {
            return unknown();
        }
        let size = Ball {
            value: self.value.abs(),
            error: self.error,
        };
        let grown = size.call("log").scale(p).call("exp");
        if self.value.hi < 0.0 && p % 2.0 != 0.0 {
            grown.negative()
        } else {
            grown
        }
    }

    fn whole_power(self, p: u32) -> Ball {
        let (mut square, mut all, mut left) = (self, Ball::ONE, p);
        while left > 0 {
            if left % 2 == 1 {
                all = if all == Ball::ONE {
                    square
                } else {
                    all.times(square)
                };
            }
            left /= 2;
            if left > 0 {
                square = square.times(square);
            }
        }
        all
    }

    /// A function of one argument, by name.
    pub fn call(self, name: &str) -> Ball {
        let (x, e) = (self.value, self.error);
        let smooth = |value: DoubleDouble, slope: f64, rounding: f64| {
            // The slope bounds the change only while the error is small against the scale on which the slope changes.
            let error = if e == 0.0 { 0.0 } else { 2.0 * slope * e };
            if e > ARITHMETIC.linearisation {
                return unknown();
            }
            Ball::with(value, error, ACCURACY * rounding)
        };
        let zero = x == DoubleDouble::ZERO && e == 0.0;
        match name {
            "sin" | "tan" | "sinh" | "tanh" | "asin" | "atan" if zero => self,
            "cos" | "cosh" | "exp" if zero => Ball::ONE,
            "sin" | "cos" | "tan" if x.hi.abs() > ARITHMETIC.angle => unknown(),
            "sin" => smooth(sin_cos(x).0, 1.0, 1.0),
            "cos" => smooth(sin_cos(x).1, 1.0, 1.0),
            "tan" => {
                let (sin, cos) = sin_cos(x);
                let part = |value| Ball {
                    value,
                    error: 2.0 * e + ACCURACY,
                };
                part(sin).over(part(cos))
            }
            "asin" | "acos" => {
                let value = if name == "asin" { asin(x) } else { acos(x) };
                let room = (1.0 - (x.hi.abs() + e)).max(0.0);
                let error = match e {
                    0.0 => 0.0,
                    // arccos(1 − h) ≤ π √(h/2)
                    e => (e / room.sqrt()).min(2.23 * e.sqrt()),
                };
                Ball::with(value, 2.0 * error, 4.0 * ACCURACY)
            }
            "atan" => smooth(atan(x), 1.0, 4.0),
            "sinh" | "cosh" => {
                let (sinh, cosh) = sinh_cosh(x);
                let value = if name == "sinh" { sinh } else { cosh };
                smooth(value, cosh.hi, 4.0 * cosh.hi)
            }
            "tanh" => smooth(tanh(x), 1.0, 8.0),
            "exp" => {
                let value = exp(x);
                smooth(value, value.hi, value.hi + f64::MIN_POSITIVE)
            }
            "log" => {
                let value = log(x);
                let slope = 1.0 / self.lower();
                if e * slope > ARITHMETIC.linearisation {
                    return unknown();
                }
                Ball::with(
                    value,
                    if e == 0.0 { 0.0 } else { 2.0 * e * slope },
                    4.0 * ACCURACY * (1.0 + value.hi.abs()),
                )
            }
            "sqrt" => self.sqrt(),
            "abs" => Ball {
                value: x.abs(),
                error: e,
            },
            "sign" => Ball {
                value: DoubleDouble::from(match x.hi {
                    h if h > 0.0 => 1.0,
                    h if h < 0.0 => -1.0,
                    h => h,
                }),
                // Zero lies in the ball: either sign is possible.
                error: if e > 0.0 && x.hi.abs() <= e { 2.0 } else { 0.0 },
            },
            // ½ + ½ sign
            "step" => {
                let side = self.call("sign");
                Ball {
                    value: DoubleDouble::from(0.5 + 0.5 * side.value.hi),
                    error: 0.5 * side.error,
                }
            }
            _ => unknown(),
        }
    }

    /// The smaller (`toward` −1) or larger (1) of two numbers.
    pub fn pick(self, other: Ball, toward: f64) -> Ball {
        let difference = (self.value - other.value).hi;
        let chosen = if difference * toward >= 0.0 {
            self
        } else {
            other
        };
        Ball {
            value: chosen.value,
            error: self.error.max(other.error),
        }
    }
}

/// Bound on the rounding of a product or quotient.
fn rounded(value: DoubleDouble, of_something: bool) -> f64 {
    let size = value.hi.abs();
    match of_something && size < ARITHMETIC.underflow {
        true => ROUNDING * size + f64::MIN_POSITIVE,
        false => ROUNDING * size,
    }
}

/// The ball of all numbers.
pub fn unknown() -> Ball {
    Ball {
        value: DoubleDouble::from(f64::NAN),
        error: f64::INFINITY,
    }
}
