//! The one table of elementary functions: a function is added by one line here.

use num_traits::Float;

/// An elementary function of the language.
#[derive(Debug)]
pub struct Function {
    /// Name in the language and in results.
    pub name: &'static str,
    /// Fewest and most arguments.
    pub arity: (usize, usize),
    /// Value; NaN or ±∞ outside the domain.
    pub eval: fn(&[f64]) -> f64,
    /// Where it is real and finite, in words; empty if everywhere.
    pub domain: &'static str,
    /// LaTeX operator.
    pub latex: &'static str,
    /// Rust method or function of f64: called as `(arg).name(rest…)`.
    pub rust: &'static str,
    /// What f(−x) is.
    pub symmetry: Symmetry,
}

/// How a function of one argument answers a change of its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// f(−x) = f(x)
    Even,
    /// f(−x) = −f(x)
    Odd,
    None,
}

impl Function {
    const fn even(mut self) -> Function {
        self.symmetry = Symmetry::Even;
        self
    }

    const fn odd(mut self) -> Function {
        self.symmetry = Symmetry::Odd;
        self
    }
}

const fn one(
    name: &'static str,
    eval: fn(&[f64]) -> f64,
    domain: &'static str,
    latex: &'static str,
    rust: &'static str,
) -> Function {
    Function {
        name,
        arity: (1, 1),
        eval,
        domain,
        latex,
        rust,
        symmetry: Symmetry::None,
    }
}

/// −1, 0 or 1: unlike `f64::signum`, zero has no sign (Coulomb friction at rest).
fn sign<T: Float>(x: T) -> T {
    if x == T::zero() { x } else { x.signum() }
}

/// Every function; the order is also the order of factors in a printed term.
#[rustfmt::skip]
pub static FUNCTIONS: &[Function] = &[
    one("sin",  |x| x[0].sin(),  "", r"\sin", "sin").odd(),
    one("cos",  |x| x[0].cos(),  "", r"\cos", "cos").even(),
    one("tan",  |x| x[0].tan(),  "", r"\tan", "tan").odd(),
    one("asin", |x| x[0].asin(), "arguments in [-1, 1]", r"\arcsin", "asin").odd(),
    one("acos", |x| x[0].acos(), "arguments in [-1, 1]", r"\arccos", "acos"),
    one("atan", |x| x[0].atan(), "", r"\arctan", "atan").odd(),
    one("sinh", |x| x[0].sinh(), "arguments below 710", r"\sinh", "sinh").odd(),
    one("cosh", |x| x[0].cosh(), "arguments below 710", r"\cosh", "cosh").even(),
    one("tanh", |x| x[0].tanh(), "", r"\tanh", "tanh").odd(),
    one("exp",  |x| x[0].exp(),  "arguments below 709", r"\exp", "exp"),
    one("log",  |x| x[0].ln(),   "positive arguments", r"\ln", "ln"),
    one("sqrt", |x| x[0].sqrt(), "arguments of zero or more", r"\sqrt", "sqrt"),
    one("abs",  |x| x[0].abs(),  "", r"\operatorname{abs}", "abs").even(),
    one("sign", |x| sign(x[0]),  "", r"\operatorname{sign}", "sign").odd(),
    Function { name: "min", arity: (2, 16), eval: |x| x.iter().copied().fold(f64::INFINITY, f64::min), domain: "", latex: r"\min", rust: "min", symmetry: Symmetry::None },
    Function { name: "max", arity: (2, 16), eval: |x| x.iter().copied().fold(f64::NEG_INFINITY, f64::max), domain: "", latex: r"\max", rust: "max", symmetry: Symmetry::None },
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
