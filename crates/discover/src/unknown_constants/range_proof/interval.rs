//! Enclosures of expressions: an interval that holds every value while one signal runs over a range.
//!
//! In: an expression, an interval for each signal. Out: an interval (Moore 1966). Bounds are moved outwards by the rounding of each
//! operation. Where nothing is known, the interval is the whole line.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use sidc_lang::term::{Atom, Expr, Signal, Term, power};

/// The numbers from `lo` to `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub lo: f64,
    pub hi: f64,
}

/// More than the relative error of any operation and any function of the standard library.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Interval {
    pub const WHOLE: Interval = Interval {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };

    pub fn point(x: f64) -> Interval {
        Interval::of(x, x)
    }

    /// The whole line if an end is not a number.
    pub fn of(lo: f64, hi: f64) -> Interval {
        match lo <= hi {
            true => Interval { lo, hi },
            false => Interval::WHOLE,
        }
    }

    /// `middle` ± `radius`
    pub fn about(middle: f64, radius: f64) -> Interval {
        Interval::of(middle - radius, middle + radius).outward()
    }

    pub fn is_finite(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    pub fn middle(self) -> f64 {
        0.5 * (self.lo + self.hi)
    }

    /// Half the width, rounded up.
    pub fn radius(self) -> f64 {
        let middle = self.middle();
        (self.hi - middle).max(middle - self.lo) * (1.0 + ROUNDING)
    }

    /// The largest magnitude.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    fn holds(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// Both ends moved outwards by rounding.
    fn outward(self) -> Interval {
        let step = |x: f64| ROUNDING * x.abs() + f64::MIN_POSITIVE;
        Interval::of(self.lo - step(self.lo), self.hi + step(self.hi))
    }

    pub fn plus(self, other: Interval) -> Interval {
        Interval::of(self.lo + other.lo, self.hi + other.hi).outward()
    }

    pub fn minus(self, other: Interval) -> Interval {
        self.plus(other.times(Interval::point(-1.0)))
    }

    pub fn times(self, other: Interval) -> Interval {
        let ends = [
            self.lo * other.lo,
            self.lo * other.hi,
            self.hi * other.lo,
            self.hi * other.hi,
        ];
        if ends.iter().any(|x| x.is_nan()) {
            return Interval::WHOLE;
        }
        let lo = ends.into_iter().fold(f64::INFINITY, f64::min);
        let hi = ends.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Interval::of(lo, hi).outward()
    }

    /// The square, never negative.
    pub fn square(self) -> Interval {
        self.power(2.0)
    }

    fn power(self, p: f64) -> Interval {
        if p == 1.0 {
            return self;
        }
        let ends = (power(self.lo, p), power(self.hi, p));
        let rising = Interval::of(ends.0.min(ends.1), ends.0.max(ends.1));
        let nan = ends.0.is_nan() || ends.1.is_nan();
        let whole = p.fract() == 0.0;
        let even = whole && p % 2.0 == 0.0;
        if nan || (!whole && self.lo < 0.0) || (p < 0.0 && self.holds(0.0)) {
            return Interval::WHOLE;
        }
        let wide = rising.outward();
        match even && self.holds(0.0) {
            true => Interval { lo: 0.0, ..wide },
            false => wide,
        }
    }

    /// Of a function that rises.
    fn rising(self, f: impl Fn(f64) -> f64) -> Interval {
        Interval::of(f(self.lo), f(self.hi)).outward()
    }

    fn sine(self) -> Interval {
        // Reduced arguments are off by the rounding of the argument itself.
        let off = ROUNDING * self.magnitude();
        let (lo, hi) = (self.lo - off, self.hi + off);
        if !self.is_finite() || hi - lo >= TAU {
            return Interval::of(-1.0, 1.0);
        }
        let meets = |at: f64| ((lo - at) / TAU).ceil() <= ((hi - at) / TAU).floor();
        let (a, b) = (lo.sin(), hi.sin());
        let least = if meets(-FRAC_PI_2) { -1.0 } else { a.min(b) };
        let most = if meets(FRAC_PI_2) { 1.0 } else { a.max(b) };
        Interval::of(least, most).outward()
    }

    fn tangent(self) -> Interval {
        let poles = |x: f64| ((x - FRAC_PI_2) / PI).floor();
        match self.is_finite() && poles(self.lo) == poles(self.hi) {
            true => self.rising(f64::tan),
            false => Interval::WHOLE,
        }
    }

    fn magnitudes(self) -> Interval {
        match self.holds(0.0) {
            true => Interval::of(0.0, self.magnitude()),
            false => Interval::of(self.lo.abs().min(self.hi.abs()), self.magnitude()),
        }
    }
}

/// What a function of one argument does with an interval; the whole line for one that is not known here.
fn function(name: &str, x: Interval) -> Interval {
    match name {
        "sin" => x.sine(),
        "cos" => x.plus(Interval::point(FRAC_PI_2)).sine(),
        "tan" => x.tangent(),
        "asin" => x.rising(f64::asin),
        "acos" => Interval::of(x.hi.acos(), x.lo.acos()).outward(),
        "atan" => x.rising(f64::atan),
        "sinh" => x.rising(f64::sinh),
        "cosh" => x.magnitudes().rising(f64::cosh),
        "tanh" => x.rising(f64::tanh),
        "exp" => x.rising(f64::exp),
        "log" => x.rising(f64::ln),
        "sqrt" => x.rising(f64::sqrt),
        _ => Interval::WHOLE,
    }
}

/// Whether an expression has kinks or jumps by a signal, where second derivatives say nothing.
pub(super) fn has_kinks(term: &Term, by: Signal) -> bool {
    let of_expr = |e: &Expr| e.terms().any(|(_, t)| has_kinks(t, by));
    let mut atoms = term.factors().map(|(atom, _)| atom);
    atoms.any(|atom| match atom {
        Atom::Signal(_) => false,
        Atom::Sum(e) => of_expr(e),
        Atom::Call(f, args) => {
            (f.switches() && args.iter().any(|a| a.mentions(by))) || args.iter().any(of_expr)
        }
    })
}

/// An expression over the intervals of its signals.
pub(super) fn enclose(e: &Expr, at: &dyn Fn(Signal) -> Interval) -> Interval {
    let mut sum = Interval::point(0.0);
    for (weight, term) in e.terms() {
        sum = sum.plus(Interval::point(weight).times(enclose_term(term, at)));
    }
    sum
}

/// A term over the intervals of its signals.
pub(super) fn enclose_term(term: &Term, at: &dyn Fn(Signal) -> Interval) -> Interval {
    let mut all = Interval::point(1.0);
    for (atom, exponent) in term.factors() {
        let value = match atom {
            Atom::Signal(s) => at(*s),
            Atom::Sum(e) => enclose(e, at),
            Atom::Call(f, args) => match args.as_ref() {
                [x] if !f.switches() => function(f.name, enclose(x, at)),
                // Without the constant all arguments are points, to rounding.
                args => {
                    let args: Vec<Interval> = args.iter().map(|a| enclose(a, at)).collect();
                    let points: Vec<f64> = args.iter().map(|a| a.middle()).collect();
                    Interval::point((f.eval)(&points)).outward()
                }
            },
        };
        all = all.times(value.power(exponent));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::{Func, VarId};
    use sidc_random::Numbers;

    /// Random expressions of both kinds of signals: every value in the range lies in the enclosure, and that of a narrow range is narrow.
    #[test]
    fn enclosures_hold_every_value() {
        let mut numbers = Numbers(11);
        let [x, k] = [0, 1].map(|v| Signal::new(VarId(v)));
        let names = ["sin", "cos", "atan", "sinh", "cosh", "tanh", "exp", "tan"];
        for round in 0..2000 {
            let [a, b] = [x, k].map(Expr::signal);
            let call = |name: &str, e: Expr| match Func::named(name) {
                Some(f) => Expr::call(f, vec![e]),
                None => Expr::zero(),
            };
            let name = names[round % names.len()];
            let inner = a.clone() * b.clone() + b.clone().pow(2.0).scale(numbers.next());
            let e = call(name, inner.clone()).pow([1.0, 2.0, 3.0][round % 3])
                + (b.clone().pow(2.0) + Expr::number(0.5)).pow(-1.0) * a.clone()
                + call("sqrt", inner.pow(2.0) + Expr::number(0.1));
            let e = if round % 2 == 0 { e.derivative(k) } else { e };
            let row = 2.0 * numbers.next();
            let from = 2.0 * numbers.next();
            let to = from + [1e-6, 0.1, 1.0][round % 3];
            let at = |s: Signal| match s == k {
                true => Interval::of(from, to),
                false => Interval::point(row),
            };
            let found = enclose(&e, &at);
            for m in 0..=100 {
                let value = from + (to - from) * f64::from(m) / 100.0;
                let y = e.eval(&|s: Signal| if s == k { value } else { row });
                assert!(found.holds(y), "{name} {y} {found:?}");
            }
            if to - from < 1e-5 && name != "tan" {
                let size = found.magnitude().max(1.0);
                assert!(found.radius() < 1e-2 * size * size, "{name} {found:?}");
            }
        }
    }

    #[test]
    fn kinks_are_seen_where_the_constant_moves_them() {
        let [x, k] = [0, 1].map(|v| Signal::new(VarId(v)));
        let term = |e: Expr| e.terms().next().map(|(_, t)| t.clone()).unwrap();
        let abs = |e: Expr| Expr::call(Func::named("abs").unwrap(), vec![e]);
        let [a, b] = [x, k].map(Expr::signal);
        assert!(has_kinks(&term(abs(a.clone() - b.clone())), k));
        assert!(!has_kinks(&term(abs(a.clone()) * b.clone()), k));
        let exp = Func::named("exp").unwrap();
        assert!(has_kinks(&term(Expr::call(exp, vec![abs(a * b)])), k));
    }
}
