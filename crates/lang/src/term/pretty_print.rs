//! Prints terms in any notation, with the parentheses that operator precedence needs.
//!
//! In: terms and a [`Notation`], which says how numbers, names, calls, powers and products look. Out: text, and how tightly it binds.
//! Unknown constants stand before the other factors, which keep their order.

use crate::number::rounded;
use crate::term::{Atom, Expr, Func, Signal, SignalNames, Term};

/// How tightly a piece of text binds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Precedence {
    Sum,
    Product,
    Power,
    Atom,
}

/// A written language for terms.
pub trait Notation {
    fn signal(&self, s: Signal) -> String;
    fn number(&self, x: f64) -> String;
    fn call(&self, f: Func, args: &[String]) -> String;
    /// `base` binds at least as tightly as an atom; `exponent` is a positive number or was made by [`Notation::exponent`].
    fn power(&self, base: &str, exponent: &str) -> (String, Precedence);
    /// An exponent from its text, and how tightly that binds.
    fn exponent(&self, text: String, _: Precedence) -> String {
        text
    }
    /// Whether the signal is an unknown constant.
    fn is_constant(&self, s: Signal) -> bool;
    /// Factors that bind at least as tightly as a product; never empty.
    fn product(&self, factors: &[String]) -> String;
    fn quotient(&self, above: &str, below: &[String]) -> String;
    fn parenthesise(&self, inner: &str) -> String {
        format!("({inner})")
    }
    /// The sign before a summand; empty before a first positive one.
    fn sign(&self, first: bool, negative: bool) -> &'static str {
        match (first, negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        }
    }
}

/// A term in the given notation, and how tightly its text binds.
pub fn write_term(n: &impl Notation, term: &Term) -> (String, Precedence) {
    let (mut above, mut below) = (Vec::new(), Vec::new());
    let is_constant = |atom: &Atom| matches!(atom, Atom::Signal(signal) if n.is_constant(*signal));
    let (constants, others): (Vec<_>, Vec<_>) =
        term.factors().partition(|(atom, _)| is_constant(atom));
    for (atom, p) in constants.into_iter().chain(others) {
        if p < 0.0 {
            below.push(write_factor(n, atom, -p));
        } else {
            above.push(write_factor(n, atom, p));
        }
    }
    if below.is_empty() && above.len() == 1 {
        return above.swap_remove(0);
    }
    let texts = |fs: Vec<(String, Precedence)>| -> Vec<String> {
        fs.into_iter()
            .map(|(t, p)| guard(n, t, p, Precedence::Power))
            .collect()
    };
    let (above, below) = (texts(above), texts(below));
    let numerator = if above.is_empty() {
        n.number(1.0)
    } else {
        n.product(&above)
    };
    if below.is_empty() {
        let p = if above.is_empty() {
            Precedence::Atom
        } else {
            Precedence::Product
        };
        return (numerator, p);
    }
    (n.quotient(&numerator, &below), Precedence::Product)
}

/// An expression in the given notation, and how tightly its text binds.
pub fn write_expr(n: &impl Notation, e: &Expr) -> (String, Precedence) {
    if let (1, Some((1.0, term))) = (e.terms().len(), e.terms().next()) {
        return write_term(n, term);
    }
    let mut out = String::new();
    let mut single = Precedence::Atom;
    for (i, (w, t)) in positive_first(e).into_iter().enumerate() {
        let (text, p) = write_weighted(n, w.abs(), t);
        if i == 0 {
            single = if w < 0.0 { Precedence::Sum } else { p };
        }
        out.push_str(n.sign(i == 0, w < 0.0));
        out.push_str(&guard(n, text, p, Precedence::Product));
    }
    match e.terms().len() {
        0 => (n.number(0.0), Precedence::Atom),
        1 => (out, single),
        _ => (out, Precedence::Sum),
    }
}

/// The terms in order, except that a positive one comes first: `x2 - x1`, not `-x1 + x2`.
fn positive_first(e: &Expr) -> Vec<(f64, &Term)> {
    let mut terms: Vec<(f64, &Term)> = e.terms().collect();
    if let Some(first) = terms.iter().position(|(w, _)| *w > 0.0) {
        terms[..=first].rotate_right(1);
    }
    terms
}

fn write_weighted(n: &impl Notation, w: f64, t: &Term) -> (String, Precedence) {
    if t.is_one() {
        return (n.number(w), Precedence::Atom);
    }
    let (text, p) = write_term(n, t);
    if w == 1.0 {
        return (text, p);
    }
    let text = guard(n, text, p, Precedence::Product);
    (n.product(&[n.number(w), text]), Precedence::Product)
}

fn write_factor(n: &impl Notation, atom: &Atom, p: f64) -> (String, Precedence) {
    let (base, binds) = match atom {
        Atom::Signal(s) => (n.signal(*s), Precedence::Atom),
        Atom::Call(f, args) => match atom.as_power(&|s| n.is_constant(s)) {
            Some((base, exponent)) => write_power(n, base, &exponent),
            None => {
                let args: Vec<String> = args.iter().map(|a| write_expr(n, a).0).collect();
                (n.call(*f, &args), Precedence::Atom)
            }
        },
        Atom::Sum(e) => write_expr(n, e),
    };
    if p == 1.0 {
        return (base, binds);
    }
    n.power(&guard(n, base, binds, Precedence::Atom), &n.number(p))
}

fn write_power(n: &impl Notation, base: &Expr, exponent: &Expr) -> (String, Precedence) {
    let ((base, binds), (exponent, loose)) = (write_expr(n, base), write_expr(n, exponent));
    let base = guard(n, base, binds, Precedence::Atom);
    n.power(&base, &n.exponent(exponent, loose))
}

fn guard(n: &impl Notation, text: String, has: Precedence, needs: Precedence) -> String {
    if has < needs {
        n.parenthesise(&text)
    } else {
        text
    }
}

/// The notation of the `.sid` language, which results carry: explicit `*`, `^`, `sin(x)`.
pub struct Language<'a, N: ?Sized>(pub &'a N);

impl<N: SignalNames + ?Sized> Language<'_, N> {
    pub fn term(&self, t: &Term) -> String {
        write_term(self, t).0
    }

    pub fn expr(&self, e: &Expr) -> String {
        write_expr(self, e).0
    }

    /// A sum of weighted terms, with weights of `digits` digits: `1.2*x - 0.5*x^3`.
    pub fn sum<'t>(&self, terms: impl Iterator<Item = (f64, &'t Term)>, digits: usize) -> String {
        let rounded = terms.map(|(w, t)| Expr::from((rounded(w, digits), t.clone())));
        self.expr(&rounded.sum())
    }
}

impl<N: SignalNames + ?Sized> Notation for Language<'_, N> {
    fn signal(&self, s: Signal) -> String {
        self.0.name(s)
    }

    fn number(&self, x: f64) -> String {
        format!("{x}")
    }

    fn call(&self, f: Func, args: &[String]) -> String {
        format!("{}({})", f.name, args.join(", "))
    }

    fn power(&self, base: &str, exponent: &str) -> (String, Precedence) {
        (format!("{base}^{exponent}"), Precedence::Power)
    }

    fn exponent(&self, text: String, binds: Precedence) -> String {
        guard(self, text, binds, Precedence::Atom)
    }

    fn is_constant(&self, s: Signal) -> bool {
        self.0.is_constant(s.var)
    }

    fn product(&self, factors: &[String]) -> String {
        factors.join("*")
    }

    fn quotient(&self, above: &str, below: &[String]) -> String {
        match below {
            [one] => format!("{above}/{one}"),
            many => format!("{above}/({})", many.join("*")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::term::VarId;

    struct Xyz;
    impl SignalNames for Xyz {
        fn variable(&self, var: VarId) -> &str {
            ["t", "x", "y", "z"][var.0 as usize]
        }
    }

    fn x() -> Expr {
        Expr::signal(Signal::new(VarId(1)))
    }
    fn y() -> Expr {
        Expr::signal(Signal::new(VarId(2)))
    }
    fn text(e: Expr) -> String {
        Language(&Xyz).expr(&e)
    }

    #[test]
    fn equal_terms_have_one_form() {
        assert_eq!(x() * y(), y() * x());
        assert_eq!(x() * y() / y(), x());
        assert_eq!(x() + y() - y(), x());
        assert_eq!(x().pow(2.0) * x(), x().pow(3.0));
    }

    #[test]
    fn parentheses_stand_where_they_must() {
        let one_minus_x = Expr::number(1.0) - x();
        assert_eq!(text(x() * one_minus_x.clone()), "x*(1 - x)");
        assert_eq!(text(one_minus_x.clone().pow(2.0)), "(1 - x)^2");
        assert_eq!(text(y() / (x() * one_minus_x)), "y/(x*(1 - x))");
        assert_eq!(text(x().pow(-1.0)), "1/x");
        assert_eq!(text(Expr::number(2.0) * x() - y()), "2*x - y");
        assert_eq!(text(x() * Expr::number(-3.0)), "-3*x");
        let sin = |e| Expr::call(Func::named("sin").unwrap(), vec![e]);
        assert_eq!(text(sin(x().scale(2.0)).pow(2.0) * y()), "y*sin(2*x)^2");
    }

    #[test]
    fn roots_of_squares_keep_their_sign() {
        let e = x().pow(2.0).pow(0.5);
        assert_eq!(e.eval(&|_| -3.0), 3.0);
        assert_eq!(text(e), "(x^2)^0.5");
        let e = x().scale(-1.0).pow(0.5);
        assert_eq!(e.eval(&|_| -4.0), 2.0);
        assert_eq!(text(e), "(-x)^0.5");
        // (x y)^0.5 is real if both are negative.
        let e = (x() * y()).pow(0.5);
        assert_eq!(e.eval(&|_| -3.0), 3.0);
        assert_eq!(text(e), "(x*y)^0.5");
        assert_eq!(text(x().scale(4.0).pow(0.5)), "2*x^0.5");
        assert_eq!(text(x().scale(-2.0).pow(2.0)), "4*x^2");
        assert_eq!(text(x() - x()), "0");
    }

    #[test]
    fn unknown_constants_come_first() {
        struct WithConstant;
        impl SignalNames for WithConstant {
            fn variable(&self, var: VarId) -> &str {
                Xyz.variable(var)
            }
            fn is_constant(&self, var: VarId) -> bool {
                var.0 == 3
            }
        }
        let z = || Expr::signal(Signal::new(VarId(3)));
        let text = |e: Expr| Language(&WithConstant).expr(&e);
        assert_eq!(text(x() * y() * z()), "z*x*y");
        assert_eq!(text(y() / (x() * z().pow(2.0))), "y/(z^2*x)");
        assert_eq!(text(x() * (z() + y())), "x*(y + z)");
    }
}
