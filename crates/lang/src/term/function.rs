//! The table of elementary functions. One line here adds a function.
//!
//! In: names, arguments. Out: values, derivatives, spellings in each target language, symmetry, units. Evaluates no expression.

use num_traits::Float;

use crate::term::Expr;

/// An elementary function of the language.
#[derive(Debug)]
pub struct Function {
    /// Name in the language and in results.
    pub name: &'static str,
    /// Fewest and most arguments.
    pub arity: (usize, usize),
    /// Value; NaN or ±∞ outside the domain.
    pub eval: fn(&[f64]) -> f64,
    /// Partial derivative with respect to the argument of this index, as an expression of the arguments. At a kink it is the mean of both
    /// sides; of `sign` and `step` it is 0, at the jump too.
    pub slope: fn(&[Expr], usize) -> Expr,
    /// Where it is real and finite, in words; empty if everywhere.
    pub domain: &'static str,
    /// LaTeX operator.
    pub latex: &'static str,
    /// What it is called in code.
    pub spelling: Spelling,
    /// What f(−x) is.
    pub symmetry: Symmetry,
    /// Whether it bends or jumps somewhere: laws with it switch there.
    pub smoothness: Smoothness,
    /// What units it takes and gives.
    pub units: UnitRule,
}

/// What a function does with units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitRule {
    /// Takes pure numbers and gives one.
    Pure,
    /// All arguments and the value have one unit.
    Kept,
    /// The value has the root of the argument's unit.
    Root,
    /// Any argument; the value is a pure number.
    Lost,
}

/// The name of a function in each target language; empty if the language lacks it, so that the target refuses it.
///
/// A call with more than two arguments is written as nested calls of two, from left to right.
#[derive(Clone, Copy, Debug)]
pub struct Spelling {
    /// Function of `f64`, or a helper that the target brings (`sign`).
    pub rust: &'static str,
    /// Function of `math.h`, or a helper that the target brings.
    pub c: &'static str,
    pub numpy: &'static str,
    pub sympy: &'static str,
    /// MATLAB and Octave. With `real_` in front, complex values become NaN.
    pub matlab: &'static str,
}

/// The same word in every language.
const fn all(name: &'static str) -> Spelling {
    spelled(name, name, name, name, name)
}

const fn spelled(
    rust: &'static str,
    c: &'static str,
    numpy: &'static str,
    sympy: &'static str,
    matlab: &'static str,
) -> Spelling {
    Spelling {
        rust,
        c,
        numpy,
        sympy,
        matlab,
    }
}

/// What a function of one argument does when its argument changes sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// f(−x) = f(x)
    Even,
    /// f(−x) = −f(x)
    Odd,
    None,
}

/// Whether a function or its slope jumps where its argument is zero, or where arguments of several are equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothness {
    Smooth,
    /// The slope jumps.
    Bends,
    /// The value jumps.
    Jumps,
}

impl Function {
    /// Whether a law with it switches.
    pub fn switches(&self) -> bool {
        self.smoothness != Smoothness::Smooth
    }

    const fn that(mut self, smoothness: Smoothness) -> Function {
        self.smoothness = smoothness;
        self
    }

    const fn even(mut self) -> Function {
        self.symmetry = Symmetry::Even;
        self
    }

    const fn odd(mut self) -> Function {
        self.symmetry = Symmetry::Odd;
        self
    }

    const fn with_units(mut self, rule: UnitRule) -> Function {
        self.units = rule;
        self
    }
}

const fn one(
    name: &'static str,
    eval: fn(&[f64]) -> f64,
    slope: fn(&[Expr], usize) -> Expr,
    domain: &'static str,
    latex: &'static str,
    spelling: Spelling,
) -> Function {
    Function {
        name,
        arity: (1, 1),
        eval,
        slope,
        domain,
        latex,
        spelling,
        symmetry: Symmetry::None,
        smoothness: Smoothness::Smooth,
        units: UnitRule::Pure,
    }
}

/// −1, 0 or 1: unlike `f64::signum`, zero has no sign (Coulomb friction at rest).
fn sign<T: Float>(x: T) -> T {
    if x == T::zero() { x } else { x.signum() }
}

/// 0, ½ or 1: the part of a law that acts beyond a threshold. Code computes it by `sign`.
fn step(x: f64) -> f64 {
    0.5 * (1.0 + sign(x))
}

/// The call of a function of one argument by name, for slopes. NaN for a name that is not in the table.
fn of(name: &str, x: &Expr) -> Expr {
    match Func::named(name) {
        Some(f) => Expr::call(f, vec![x.clone()]),
        None => Expr::number(f64::NAN),
    }
}

/// 1 + k·x²
fn one_plus(k: f64, x: Expr) -> Expr {
    Expr::number(1.0) + x.pow(2.0).scale(k)
}

/// The derivative of `min` or `max` (`f`) with respect to argument `i`: 1 where that argument is taken, 0 elsewhere. `toward` is 1 for max,
/// −1 for min.
///
/// Compares the extreme so far with the next argument, from left to right. A tie gives half to each side, so that the derivatives with
/// respect to all arguments add up to 1 however many are tied.
fn extremum_derivative(f: &str, toward: f64, x: &[Expr], i: usize) -> Expr {
    let best = |n: usize| match (Func::named(f), x.get(..n)) {
        (Some(f), Some(first)) if n > 1 => Expr::call(f, first.to_vec()),
        _ => x.first().cloned().unwrap_or_default(),
    };
    let beats = |a: Expr, b: Expr| {
        let ahead = of("sign", &(a - b).scale(toward));
        (Expr::number(1.0) + ahead).scale(0.5)
    };
    let arrives = match x.get(i) {
        Some(own) if i > 0 => beats(own.clone(), best(i)),
        _ => Expr::number(1.0),
    };
    let later = x.iter().enumerate().skip(i + 1);
    later.fold(arrives, |stays, (j, next)| {
        stays * beats(best(j), next.clone())
    })
}

/// Every function; the order is also the order of factors in a printed term.
#[rustfmt::skip]
pub static FUNCTIONS: &[Function] = &[
    one("sin",  |x| x[0].sin(),  |x, _| of("cos", &x[0]), "", r"\sin", all("sin")).odd(),
    one("cos",  |x| x[0].cos(),  |x, _| of("sin", &x[0]).scale(-1.0), "", r"\cos", all("cos")).even(),
    one("tan",  |x| x[0].tan(),  |x, _| one_plus(1.0, of("tan", &x[0])), "", r"\tan", all("tan")).odd(),
    one("asin", |x| x[0].asin(), |x, _| one_plus(-1.0, x[0].clone()).pow(-0.5), "arguments in [-1, 1]", r"\arcsin", spelled("asin", "asin", "arcsin", "asin", "real_asin")).odd(),
    one("acos", |x| x[0].acos(), |x, _| one_plus(-1.0, x[0].clone()).pow(-0.5).scale(-1.0), "arguments in [-1, 1]", r"\arccos", spelled("acos", "acos", "arccos", "acos", "real_acos")),
    one("atan", |x| x[0].atan(), |x, _| one_plus(1.0, x[0].clone()).pow(-1.0), "", r"\arctan", spelled("atan", "atan", "arctan", "atan", "atan")).odd(),
    one("sinh", |x| x[0].sinh(), |x, _| of("cosh", &x[0]), "arguments below 710", r"\sinh", all("sinh")).odd(),
    one("cosh", |x| x[0].cosh(), |x, _| of("sinh", &x[0]), "arguments below 710", r"\cosh", all("cosh")).even(),
    one("tanh", |x| x[0].tanh(), |x, _| one_plus(-1.0, of("tanh", &x[0])), "", r"\tanh", all("tanh")).odd(),
    one("exp",  |x| x[0].exp(),  |x, _| of("exp", &x[0]), "arguments below 709", r"\exp", all("exp")),
    one("log",  |x| x[0].ln(),   |x, _| x[0].clone().pow(-1.0), "positive arguments", r"\ln", spelled("ln", "log", "log", "log", "real_log")),
    one("sqrt", |x| x[0].sqrt(), |x, _| of("sqrt", &x[0]).pow(-1.0).scale(0.5), "arguments of zero or more", r"\sqrt", spelled("sqrt", "sqrt", "sqrt", "sqrt", "real_sqrt")).with_units(UnitRule::Root),
    one("abs",  |x| x[0].abs(),  |x, _| of("sign", &x[0]), "", r"\operatorname{abs}", spelled("abs", "fabs", "abs", "Abs", "abs")).even().that(Smoothness::Bends).with_units(UnitRule::Kept),
    one("sign", |x| sign(x[0]),  |_, _| Expr::zero(), "", r"\operatorname{sign}", spelled("sign", "sidc_sign", "sign", "sign", "sign")).odd().that(Smoothness::Jumps).with_units(UnitRule::Lost),
    one("step", |x| step(x[0]), |_, _| Expr::zero(), "", r"\operatorname{step}", spelled("sign", "sidc_sign", "sign", "sign", "sign")).that(Smoothness::Jumps).with_units(UnitRule::Lost),
    Function { name: "min", arity: (2, 16), eval: |x| x.iter().copied().fold(f64::NAN, f64::min), slope: |x, i| extremum_derivative("min", -1.0, x, i), domain: "", latex: r"\min", spelling: spelled("min", "fmin", "fmin", "Min", "min"), symmetry: Symmetry::None, smoothness: Smoothness::Bends, units: UnitRule::Kept },
    Function { name: "max", arity: (2, 16), eval: |x| x.iter().copied().fold(f64::NAN, f64::max), slope: |x, i| extremum_derivative("max", 1.0, x, i), domain: "", latex: r"\max", spelling: spelled("max", "fmax", "fmax", "Max", "max"), symmetry: Symmetry::None, smoothness: Smoothness::Bends, units: UnitRule::Kept },
];

/// A function by its place in [`FUNCTIONS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Func(u8);

impl Func {
    /// Looks a function up by its name in the language.
    pub fn named(name: &str) -> Option<Func> {
        FUNCTIONS
            .iter()
            .position(|f| f.name == name)
            .map(|i| Func(i as u8))
    }
}

impl std::ops::Deref for Func {
    type Target = Function;

    fn deref(&self) -> &Function {
        &FUNCTIONS[self.0 as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::{FUNCTIONS, Smoothness};

    /// Differences at zero, or at 0.5 where there is no value below zero, between arguments that are equal.
    #[test]
    fn functions_bend_and_jump_where_the_table_says() {
        let h = 1e-6;
        for f in FUNCTIONS {
            let values = |centre: f64| {
                [-h, 0.0, h].map(|off| {
                    let mut args = vec![centre; f.arity.0];
                    args[0] += off;
                    (f.eval)(&args)
                })
            };
            let [below, at, above] = match values(0.0) {
                v if v.iter().all(|x| x.is_finite()) => v,
                _ => values(0.5),
            };
            let measured = match (above - below, (above - 2.0 * at + below) / h) {
                (jump, _) if jump.abs() > 0.1 => Smoothness::Jumps,
                (_, bend) if bend.abs() > 0.1 => Smoothness::Bends,
                _ => Smoothness::Smooth,
            };
            assert_eq!(f.smoothness, measured, "{}", f.name);
        }
    }
}
