//! Terms at one row, in 106 bits, each value with a bound on its error.
//!
//! In: a term, and the value of every signal, which counts as exact. Out: a [`Bounded`]. What a function is, is said here once more, not
//! taken from the table that the rest of the program uses. A function that is not known here has no bound.

use super::double::{Double, ROUNDING};
use super::functions::{
    ACCURACY, LARGEST_ANGLE, acos, asin, atan, exp, log, sin_cos, sinh_cosh, tanh,
};
use sidc_lang::term::{Atom, Expr, Func, Signal, Term};

/// Products under this lose digits to the end of the range of f64.
const TINY: f64 = 1e-290;
/// Errors up to this part of what would matter: bounds are of first order with a factor of two.
const SMALL: f64 = 1e-3;

/// A number that is off by at most `error`; not known at all if that is not finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounded {
    pub value: Double,
    pub error: f64,
}

impl Bounded {
    pub fn exact(x: f64) -> Bounded {
        Bounded {
            value: Double::from(x),
            error: 0.0,
        }
    }

    pub const ONE: Bounded = Bounded {
        value: Double::ONE,
        error: 0.0,
    };

    /// A value whose own operation was off by `own`, beside what its arguments bring along.
    fn with(value: Double, error: f64, own: f64) -> Bounded {
        if !value.is_finite() {
            return Bounded {
                value,
                error: f64::INFINITY,
            };
        }
        // The bounds themselves are rounded.
        Bounded {
            value,
            error: (error + own) * (1.0 + 1e-12),
        }
    }

    pub fn size(self) -> f64 {
        self.value.hi.abs()
    }

    /// No value that is meant is larger.
    pub fn most(self) -> f64 {
        (self.value.value().abs() + self.error) * (1.0 + f64::EPSILON)
    }

    /// No value that is meant is smaller in size.
    pub fn least(self) -> f64 {
        ((self.value.value().abs() - self.error) * (1.0 - f64::EPSILON)).max(0.0)
    }

    pub fn add(self, other: Bounded) -> Bounded {
        let value = self.value + other.value;
        Bounded::with(value, self.error + other.error, ROUNDING * value.hi.abs())
    }

    pub fn negative(self) -> Bounded {
        Bounded {
            value: -self.value,
            error: self.error,
        }
    }

    pub fn times(self, other: Bounded) -> Bounded {
        let value = self.value * other.value;
        let crossed = self.size() * other.error + other.size() * self.error;
        Bounded::with(
            value,
            2.0 * crossed + self.error * other.error,
            rounded(value, self.size() > 0.0 && other.size() > 0.0),
        )
    }

    pub fn scale(self, k: f64) -> Bounded {
        // What is exact stays so: 1 − cos x is zero at rest, and known to be.
        match k {
            1.0 => self,
            -1.0 => self.negative(),
            k => self.times(Bounded::exact(k)),
        }
    }

    pub fn over(self, other: Bounded) -> Bounded {
        let value = self.value / other.value;
        let below = other.least();
        let error = (self.error + value.hi.abs() * other.error) / below;
        Bounded::with(value, 2.0 * error, rounded(value, self.size() > 0.0))
    }

    pub fn sqrt(self) -> Bounded {
        let value = self.value.sqrt();
        // |√a − √b| ≤ |a − b|/√a, and never more than √|a − b|.
        let error = match self.error {
            0.0 => 0.0,
            e => (e / value.hi).min(e.sqrt()),
        };
        Bounded::with(value, 2.0 * error, ROUNDING * value.hi)
    }

    /// xᵖ, as the language has it.
    fn power(self, p: f64) -> Bounded {
        if p == 0.5 {
            return self.sqrt();
        }
        if p.fract() == 0.0 && p.abs() <= 1024.0 {
            let whole = self.whole_power(p.abs() as u32);
            return if p < 0.0 {
                Bounded::ONE.over(whole)
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
        let size = Bounded {
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

    fn whole_power(self, p: u32) -> Bounded {
        let (mut square, mut all, mut left) = (self, Bounded::ONE, p);
        while left > 0 {
            if left % 2 == 1 {
                all = if all == Bounded::ONE {
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
    fn call(self, name: &str) -> Bounded {
        let (x, e) = (self.value, self.error);
        let bent = |value: Double, slope: f64, own: f64| {
            // A slope says enough only as long as the error is small beside what it changes on.
            let error = if e == 0.0 { 0.0 } else { 2.0 * slope * e };
            if e > SMALL {
                return unknown();
            }
            Bounded::with(value, error, ACCURACY * own)
        };
        let zero = x == Double::ZERO && e == 0.0;
        match name {
            "sin" | "tan" | "sinh" | "tanh" | "asin" | "atan" if zero => self,
            "cos" | "cosh" | "exp" if zero => Bounded::ONE,
            "sin" | "cos" | "tan" if x.hi.abs() > LARGEST_ANGLE => unknown(),
            "sin" => bent(sin_cos(x).0, 1.0, 1.0),
            "cos" => bent(sin_cos(x).1, 1.0, 1.0),
            "tan" => {
                let (sin, cos) = sin_cos(x);
                let part = |value| Bounded {
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
                Bounded::with(value, 2.0 * error, 4.0 * ACCURACY)
            }
            "atan" => bent(atan(x), 1.0, 4.0),
            "sinh" | "cosh" => {
                let (sinh, cosh) = sinh_cosh(x);
                let value = if name == "sinh" { sinh } else { cosh };
                bent(value, cosh.hi, 4.0 * cosh.hi)
            }
            "tanh" => bent(tanh(x), 1.0, 8.0),
            "exp" => {
                let value = exp(x);
                bent(value, value.hi, value.hi + f64::MIN_POSITIVE)
            }
            "log" => {
                let value = log(x);
                let slope = 1.0 / self.least();
                if e * slope > SMALL {
                    return unknown();
                }
                Bounded::with(
                    value,
                    if e == 0.0 { 0.0 } else { 2.0 * e * slope },
                    4.0 * ACCURACY * (1.0 + value.hi.abs()),
                )
            }
            "sqrt" => self.sqrt(),
            "abs" => Bounded {
                value: x.abs(),
                error: e,
            },
            "sign" => Bounded {
                value: Double::from(match x.hi {
                    h if h > 0.0 => 1.0,
                    h if h < 0.0 => -1.0,
                    h => h,
                }),
                // Which side it is on is not known.
                error: if e > 0.0 && x.hi.abs() <= e { 2.0 } else { 0.0 },
            },
            _ => unknown(),
        }
    }

    /// The smaller (`toward` −1) or larger (1) of two.
    fn pick(self, other: Bounded, toward: f64) -> Bounded {
        let apart = (self.value - other.value).hi;
        let chosen = if apart * toward >= 0.0 { self } else { other };
        Bounded {
            value: chosen.value,
            error: self.error.max(other.error),
        }
    }
}

/// What rounding does to a product or quotient.
fn rounded(value: Double, of_something: bool) -> f64 {
    let size = value.hi.abs();
    match of_something && size < TINY {
        true => ROUNDING * size + f64::MIN_POSITIVE,
        false => ROUNDING * size,
    }
}

/// Nothing is known of it.
fn unknown() -> Bounded {
    Bounded {
        value: Double::from(f64::NAN),
        error: f64::INFINITY,
    }
}

/// A term at one row.
pub fn term(term: &Term, at: &impl Fn(Signal) -> f64) -> Bounded {
    let factors = term.factors().map(|(a, p)| (atom(a, at), p));
    product(factors)
}

/// Powers multiplied, in order.
pub fn product(factors: impl Iterator<Item = (Bounded, f64)>) -> Bounded {
    let mut all: Option<Bounded> = None;
    for (base, p) in factors {
        let factor = base.power(p);
        all = Some(all.map_or(factor, |a| a.times(factor)));
    }
    all.unwrap_or(Bounded::ONE)
}

/// An atom at one row.
pub fn atom(a: &Atom, at: &impl Fn(Signal) -> f64) -> Bounded {
    match a {
        Atom::Signal(s) => Bounded::exact(at(*s)),
        Atom::Sum(e) => expr(e, at),
        Atom::Call(f, args) => call(*f, args, at),
    }
}

fn expr(e: &Expr, at: &impl Fn(Signal) -> f64) -> Bounded {
    let parts = e.terms().map(|(weight, t)| match weight == 1.0 {
        true => term(t, at),
        false => term(t, at).scale(weight),
    });
    // One part alone is not rounded.
    parts.reduce(Bounded::add).unwrap_or(Bounded::exact(0.0))
}

fn call(f: Func, args: &[Expr], at: &impl Fn(Signal) -> f64) -> Bounded {
    let mut values = args.iter().map(|a| expr(a, at));
    let Some(first) = values.next() else {
        return unknown();
    };
    match f.name {
        "min" => values.fold(first, |a, b| a.pick(b, -1.0)),
        "max" => values.fold(first, |a, b| a.pick(b, 1.0)),
        name => first.call(name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::{FUNCTIONS, VarId};

    fn x() -> Expr {
        Expr::signal(Signal::new(VarId(1)))
    }

    fn at(value: f64) -> impl Fn(Signal) -> f64 {
        move |s| match s.var.0 {
            1 => value,
            other => value + 0.5 - 0.2 * f64::from(other),
        }
    }

    #[test]
    fn every_function_of_the_language_is_known_and_agrees() {
        for f in FUNCTIONS {
            for point in [-2.3, -0.7, -0.01, 0.0, 0.3, 0.99, 1.0, 5.5, 40.0] {
                let mut args = vec![x()];
                args.extend(
                    (1..f.arity.1.min(3)).map(|i| Expr::signal(Signal::new(VarId(1 + i as u16)))),
                );
                let atom = Expr::call(Func::named(f.name).unwrap(), args.clone())
                    .into_term()
                    .1;
                let plain = atom.eval(&at(point));
                let found = term(&atom, &at(point));
                if plain.is_finite() {
                    let off = (found.value.value() - plain).abs();
                    let allowed = 4.0 * f64::EPSILON * plain.abs().max(1.0);
                    assert!(off <= allowed, "{}({point}): {off:e}", f.name);
                    let bound = 1e-25 * plain.abs().max(1.0);
                    assert!(
                        found.error <= bound,
                        "{}({point}): {:e}",
                        f.name,
                        found.error
                    );
                } else {
                    assert!(!found.error.is_finite(), "{}({point})", f.name);
                }
            }
        }
    }

    #[test]
    fn powers_agree_with_the_evaluator() {
        for p in [-3.0, -1.5, -1.0, -0.5, 0.5, 1.5, 2.0, 7.0, 1025.0] {
            for point in [-1.2, -0.5, 0.0, 0.4, 1.001] {
                let t = x().pow(p).into_term().1;
                let plain = t.eval(&at(point));
                let found = term(&t, &at(point));
                if plain.is_finite() && plain.abs() > 1e-300 {
                    let off = (found.value.value() - plain).abs() / plain.abs();
                    assert!(off < 1e-12, "{point}^{p}: {off:e}");
                } else if !plain.is_finite() {
                    assert!(!found.error.is_finite(), "{point}^{p}");
                }
            }
        }
    }

    #[test]
    fn bounds_hold_where_digits_cancel() {
        // 1 − cos x at 1e-9, whose value is x²/2 − x⁴/24.
        let cos = Expr::call(Func::named("cos").unwrap(), vec![x()]);
        let e = (Expr::number(1.0) - cos).into_term().1;
        let found = term(&e, &at(1e-9));
        let square = Double::product(1e-9, 1e-9).scaled(-1);
        let off = (found.value - square).abs().value();
        assert!(
            off <= found.error + 1e-37 && found.error < 1e-26,
            "{off:e} {:e}",
            found.error
        );
        // At rest it is zero, and known to be.
        assert_eq!(term(&e, &at(0.0)).error, 0.0);
    }

    #[test]
    fn a_sign_that_hangs_in_the_balance_has_a_wide_bound() {
        let sign = |of: Expr| {
            Expr::call(Func::named("sign").unwrap(), vec![of])
                .into_term()
                .1
        };
        assert_eq!(term(&sign(x()), &at(0.0)).error, 0.0);
        let sin = Expr::call(Func::named("sin").unwrap(), vec![x()]);
        let zero = sin.clone() - sin.pow(2.0).pow(0.5);
        assert_eq!(term(&sign(zero), &at(0.3)).error, 2.0);
    }
}
