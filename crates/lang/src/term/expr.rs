//! The normal form: an [`Expr`] is a sum of weighted [`Term`]s, a term a product of powers of [`Atom`]s.
//!
//! In: signals, numbers, functions. Out: expressions by `+ - * / ^` that are equal in whatever order they were written. Products of sums
//! are not multiplied out: `x*(1 - x)` stays one product, because the user wrote one candidate column.

use std::cmp::Ordering;
use std::sync::Arc;

use crate::term::{Func, Signal};

/// A factor that is not a product. Cheap to clone, since large libraries repeat each factor thousands of times.
#[derive(Clone, Debug)]
pub enum Atom {
    Signal(Signal),
    Call(Func, Arc<[Expr]>),
    /// A sum of two or more terms used as one factor.
    Sum(Arc<Expr>),
}

/// A product of powers of atoms, sorted; empty is the constant 1. No numeric factor.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Term(pub(super) Vec<Factor>);

/// A weighted sum of distinct terms, sorted by term; empty is 0. No zero weights.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Expr(Vec<Weighted>);

#[derive(Clone, Debug)]
pub(super) struct Factor {
    pub(super) atom: Atom,
    pub(super) power: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Weighted {
    pub(super) term: Term,
    pub(super) weight: f64,
}

impl Term {
    /// The constant term 1.
    pub fn one() -> Self {
        Term(Vec::new())
    }

    pub fn atom(atom: Atom) -> Self {
        Term(vec![Factor { atom, power: 1.0 }])
    }

    pub fn signal(s: Signal) -> Self {
        Term::atom(Atom::Signal(s))
    }

    pub fn is_one(&self) -> bool {
        self.0.is_empty()
    }

    /// The factors with their exponents, in order.
    pub fn factors(&self) -> impl ExactSizeIterator<Item = (&Atom, f64)> {
        self.0.iter().map(|f| (&f.atom, f.power))
    }

    /// Σ |exponents|, by which printed libraries are ordered.
    pub fn degree(&self) -> f64 {
        // Starts at +0: the empty `sum` of floats is −0, whose bits sort after all others.
        self.0.iter().fold(0.0, |sum, f| sum + f.power.abs())
    }

    pub fn mul(&self, other: &Term) -> Term {
        if let (Some(last), Some(first)) = (self.0.last(), other.0.first())
            && last.atom < first.atom
        {
            // Generators multiply in order, so there is nothing to merge.
            let mut all = Vec::with_capacity(self.0.len() + other.0.len());
            all.extend_from_slice(&self.0);
            all.extend_from_slice(&other.0);
            return Term(all);
        }
        let (mut a, mut b) = (self.0.iter().peekable(), other.0.iter().peekable());
        let mut out = Vec::with_capacity(self.0.len() + other.0.len());
        loop {
            let order = match (a.peek(), b.peek()) {
                (None, None) => return Term(out),
                (Some(_), None) => Ordering::Less,
                (None, Some(_)) => Ordering::Greater,
                (Some(x), Some(y)) => x.atom.cmp(&y.atom),
            };
            match order {
                Ordering::Less => out.extend(a.next().cloned()),
                Ordering::Greater => out.extend(b.next().cloned()),
                Ordering::Equal => {
                    if let (Some(x), Some(y)) = (a.next(), b.next()) {
                        let power = x.power + y.power;
                        if power != 0.0 {
                            out.push(Factor {
                                atom: x.atom.clone(),
                                power,
                            });
                        }
                    }
                }
            }
        }
    }

    /// `self^p`. Exponents are multiplied for integer `p` only: `(x^2)^0.5` stays a power of a power, since it is |x|.
    pub fn pow(&self, p: f64) -> Term {
        if p == 0.0 {
            return Term::one();
        }
        let distributes =
            p.fract() == 0.0 || self.0.iter().all(|f| f.power == 1.0) && self.0.len() == 1;
        if distributes {
            return Term(
                self.0
                    .iter()
                    .map(|f| Factor {
                        atom: f.atom.clone(),
                        power: f.power * p,
                    })
                    .collect(),
            );
        }
        if self.is_one() {
            return Term::one();
        }
        Term(vec![Factor {
            atom: Atom::Sum(Arc::new(Expr::from(self.clone()))),
            power: p,
        }])
    }

    /// The product of the factors whose atoms satisfy `keep`.
    pub fn part(&self, keep: impl Fn(&Atom) -> bool) -> Term {
        let kept = self.0.iter().filter(|f| keep(&f.atom));
        Term(kept.cloned().collect())
    }

    /// Calls `visit` for every signal in the term, arguments and sums included.
    pub fn for_each_signal(&self, visit: &mut impl FnMut(Signal)) {
        for f in &self.0 {
            f.atom.for_each_signal(visit);
        }
    }

    /// True if the signal occurs anywhere in the term.
    pub fn mentions(&self, s: Signal) -> bool {
        let mut found = false;
        self.for_each_signal(&mut |t| found |= t == s);
        found
    }

    /// Value at one sample, given the value of each signal there.
    pub fn eval(&self, at: &impl Fn(Signal) -> f64) -> f64 {
        self.0
            .iter()
            .map(|f| power(f.atom.eval(at), f.power))
            .product()
    }
}

impl Expr {
    pub fn zero() -> Self {
        Expr(Vec::new())
    }

    pub fn number(value: f64) -> Self {
        Expr::from((value, Term::one()))
    }

    pub fn signal(s: Signal) -> Self {
        Expr::from(Term::signal(s))
    }

    /// A function of expressions; evaluated if they are numbers.
    pub fn call(f: Func, args: Vec<Expr>) -> Self {
        let numbers: Option<Vec<f64>> = args.iter().map(Expr::as_number).collect();
        match numbers {
            Some(xs) => Expr::number((f.eval)(&xs)),
            None => Expr::from(Term::atom(Atom::Call(f, args.into()))),
        }
    }

    /// The weighted terms, in order.
    pub fn terms(&self) -> impl ExactSizeIterator<Item = (f64, &Term)> {
        self.0.iter().map(|w| (w.weight, &w.term))
    }

    /// The value, if the expression has no signals.
    pub fn as_number(&self) -> Option<f64> {
        match self.0.as_slice() {
            [] => Some(0.0),
            [w] if w.term.is_one() => Some(w.weight),
            _ => None,
        }
    }

    /// The expression as numeric factor and term. A sum becomes one atom with factor 1.
    pub fn into_term(mut self) -> (f64, Term) {
        match self.0.len() {
            0 => (0.0, Term::one()),
            1 => self
                .0
                .pop()
                .map_or((0.0, Term::one()), |w| (w.weight, w.term)),
            _ => (1.0, Term::atom(Atom::Sum(Arc::new(self)))),
        }
    }

    /// Sorted, equal terms added up.
    fn merged(mut self) -> Expr {
        self.0.sort_by(|a, b| a.term.cmp(&b.term));
        self.0.dedup_by(|b, a| {
            let same = a.term == b.term;
            if same {
                a.weight += b.weight;
            }
            same
        });
        self.0.retain(|w| w.weight != 0.0);
        self
    }

    pub fn scale(mut self, k: f64) -> Expr {
        self.0.iter_mut().for_each(|w| w.weight *= k);
        self.0.retain(|w| w.weight != 0.0);
        self
    }

    pub fn pow(self, p: f64) -> Expr {
        let (k, t) = self.into_term();
        if p.fract() != 0.0 && k < 0.0 && !t.is_one() {
            // (-x)^0.5 has no real numeric factor.
            let inner = Expr::from((k, t));
            return Expr::from(Term(vec![Factor {
                atom: Atom::Sum(Arc::new(inner)),
                power: p,
            }]));
        }
        Expr::from((power(k, p), t.pow(p)))
    }

    /// True if every number in the expression is finite.
    pub fn is_finite(&self) -> bool {
        self.0
            .iter()
            .all(|w| w.weight.is_finite() && w.term.0.iter().all(Factor::is_finite))
    }

    pub fn for_each_signal(&self, visit: &mut impl FnMut(Signal)) {
        for w in &self.0 {
            w.term.for_each_signal(visit);
        }
    }

    pub fn mentions(&self, s: Signal) -> bool {
        self.0.iter().any(|w| w.term.mentions(s))
    }

    /// Value at one sample, given the value of each signal there.
    pub fn eval(&self, at: &impl Fn(Signal) -> f64) -> f64 {
        self.0.iter().map(|w| w.weight * w.term.eval(at)).sum()
    }
}

impl std::ops::Add for Expr {
    type Output = Expr;

    fn add(mut self, other: Expr) -> Expr {
        self.0.extend(other.0);
        self.merged()
    }
}

impl std::iter::Sum for Expr {
    /// Sorted once, whatever the number of summands.
    fn sum<I: Iterator<Item = Expr>>(all: I) -> Expr {
        Expr(all.flat_map(|e| e.0).collect()).merged()
    }
}

impl std::ops::Sub for Expr {
    type Output = Expr;

    fn sub(self, other: Expr) -> Expr {
        self + other.scale(-1.0)
    }
}

impl std::ops::Mul for Expr {
    type Output = Expr;

    fn mul(self, other: Expr) -> Expr {
        if let Some(k) = self.as_number() {
            return other.scale(k);
        }
        if let Some(k) = other.as_number() {
            return self.scale(k);
        }
        let ((k, a), (l, b)) = (self.into_term(), other.into_term());
        Expr::from((k * l, a.mul(&b)))
    }
}

impl std::ops::Div for Expr {
    type Output = Expr;

    /// A division by the number 0 gives an infinite weight, which [`Expr::is_finite`] finds.
    fn div(self, other: Expr) -> Expr {
        self * other.pow(-1.0)
    }
}

impl From<Term> for Expr {
    fn from(term: Term) -> Self {
        Expr::from((1.0, term))
    }
}

impl From<(f64, Term)> for Expr {
    fn from((weight, term): (f64, Term)) -> Self {
        if weight == 0.0 {
            return Expr::zero();
        }
        Expr(vec![Weighted { term, weight }])
    }
}

impl Atom {
    pub fn for_each_signal(&self, visit: &mut impl FnMut(Signal)) {
        match self {
            Atom::Signal(s) => visit(*s),
            Atom::Call(_, args) => args.iter().for_each(|a| a.for_each_signal(visit)),
            Atom::Sum(e) => e.for_each_signal(visit),
        }
    }

    /// Value at one sample, given the value of each signal there.
    pub fn eval(&self, at: &impl Fn(Signal) -> f64) -> f64 {
        match self {
            Atom::Signal(s) => at(*s),
            Atom::Call(f, args) => match args.as_ref() {
                [x] => (f.eval)(&[x.eval(at)]),
                [x, y] => (f.eval)(&[x.eval(at), y.eval(at)]),
                many => (f.eval)(&many.iter().map(|a| a.eval(at)).collect::<Vec<_>>()),
            },
            Atom::Sum(e) => e.eval(at),
        }
    }

    pub(super) fn rank(&self) -> u8 {
        match self {
            Atom::Signal(_) => 0,
            Atom::Call(..) => 1,
            Atom::Sum(_) => 2,
        }
    }
}

impl Factor {
    fn is_finite(&self) -> bool {
        self.power.is_finite()
            && match &self.atom {
                Atom::Signal(_) => true,
                Atom::Call(_, args) => args.iter().all(Expr::is_finite),
                Atom::Sum(e) => e.is_finite(),
            }
    }
}

/// `x^p`, by repeated multiplication for integers: the sign is exact, and generated code computes the same digits.
pub fn power(x: f64, p: f64) -> f64 {
    if p == 1.0 {
        x
    } else if p.fract() == 0.0 && p.abs() <= 1024.0 {
        x.powi(p as i32)
    } else {
        x.powf(p)
    }
}
