//! Set expressions from bytes, as the language writes them, and the same sets written out term by term.
//!
//! The naive side knows the algebra of terms and nothing of lists, products or blocks. It gives up on large sets.

use std::collections::BTreeSet;

use super::bytes::Bytes;
use sidc_lang::term::{Expr, Func, Signal, Term, VarId};

/// Most terms that are written out.
const MOST: usize = 2_500;
/// How deep expressions go.
const DEEP: usize = 4;

/// Variables in order of declaration; the target is the rate of x.
pub const NAMES: [&str; 7] = ["x", "y", "z", "u", "v", "p", "q"];
/// Their declarations.
pub const DECLARED: &str = "state x, y, z\ninput u, v, p, q\n";

/// dx
pub const TARGET: Signal = Signal::derivative(VarId(1), 1);

#[derive(Clone, Debug)]
pub enum Set {
    /// A term as written.
    One(usize),
    List(Vec<Set>),
    Union(Box<Set>, Box<Set>),
    Minus(Box<Set>, Box<Set>),
    Times(Box<Set>, Box<Set>),
    Over(Box<Set>, usize),
    Power(usize, u8),
    Poly(Vec<Set>, (u32, u32)),
    Powers(Vec<Set>, u32),
    Fourier(usize, u32),
}

/// A written term, and what it means.
fn atoms() -> Vec<(&'static str, Expr)> {
    let signal = |i: u16| Expr::signal(Signal::new(VarId(i)));
    let call = |name, e: Expr| Expr::call(Func::named(name).unwrap(), vec![e]);
    let (x, y, z) = (signal(1), signal(2), signal(3));
    vec![
        ("x", x.clone()),
        ("y", y.clone()),
        ("z", z.clone()),
        ("u", signal(4)),
        ("v", signal(5)),
        ("p", signal(6)),
        ("q", signal(7)),
        ("sin(x)", call("sin", x.clone())),
        ("cos(x)", call("cos", x.clone())),
        ("dx", Expr::signal(TARGET)),
        ("x*y", x.clone() * y.clone()),
        ("x^2", x.clone().pow(2.0)),
        ("1/y", y.clone().pow(-1.0)),
        ("z^0.5", z.pow(0.5)),
        ("exp(y)", call("exp", y.clone())),
        ("(1 + x)", Expr::number(1.0) + x.clone()),
        ("1", Expr::number(1.0)),
        ("2*x", x.clone().scale(2.0)),
        ("x*(1 - y)", x * (Expr::number(1.0) - y)),
    ]
}

impl Set {
    pub fn of(bytes: &mut Bytes) -> Set {
        Set::to(bytes, DEEP)
    }

    fn to(bytes: &mut Bytes, deep: usize) -> Set {
        let count = atoms().len();
        let kinds = if deep == 0 || bytes.is_empty() { 5 } else { 10 };
        let two = |bytes: &mut Bytes| [(); 2].map(|()| Box::new(Set::to(bytes, deep - 1)));
        match bytes.below(kinds) {
            0 => Set::One(bytes.below(count)),
            1 => Set::Power(bytes.below(count), bytes.below(4) as u8),
            2 => Set::Poly(args(bytes, deep), {
                let from = bytes.below(3) as u32;
                (from, from + bytes.below(4) as u32)
            }),
            3 => Set::Powers(args(bytes, deep), bytes.below(4) as u32),
            4 => Set::Fourier(bytes.below(3), 1 + bytes.below(3) as u32),
            5 => Set::List(
                (0..bytes.within(1, 4))
                    .map(|_| Set::to(bytes, deep - 1))
                    .collect(),
            ),
            6 => Set::Over(Box::new(Set::to(bytes, deep - 1)), bytes.below(count)),
            7 => {
                let [a, b] = two(bytes);
                Set::Union(a, b)
            }
            8 => {
                let [a, b] = two(bytes);
                Set::Minus(a, b)
            }
            _ => {
                let [a, b] = two(bytes);
                Set::Times(a, b)
            }
        }
    }

    /// As the language writes it.
    pub fn text(&self) -> String {
        let all = |sets: &[Set]| sets.iter().map(Set::item).collect::<Vec<_>>().join(", ");
        match self {
            Set::One(i) => format!("<{}>", atoms()[*i].0),
            Set::List(items) => format!("<{}>", all(items)),
            Set::Union(a, b) => format!("({} + {})", a.text(), b.text()),
            Set::Minus(a, b) => format!("({} - {})", a.text(), b.text()),
            Set::Times(a, b) => format!("{} * {}", a.text(), b.text()),
            Set::Over(a, i) => format!("{} / <{}>", a.text(), atoms()[*i].0),
            Set::Power(i, p) => format!("<{}>^{p}", atoms()[*i].0),
            Set::Poly(args, (from, to)) if *from == 0 => format!("poly({}; {to})", all(args)),
            Set::Poly(args, (from, to)) => format!("poly({}; {from}..{to})", all(args)),
            Set::Powers(args, p) => format!("powers({}; {p})", all(args)),
            Set::Fourier(i, n) => format!("fourier({}; {n})", NAMES[*i]),
        }
    }

    /// As an item of a list or an argument, where a term needs no brackets.
    fn item(&self) -> String {
        match self {
            Set::One(i) => atoms()[*i].0.to_string(),
            Set::List(_) | Set::Poly(..) | Set::Powers(..) | Set::Fourier(..) => self.text(),
            _ => format!("<{}>", self.parts()),
        }
    }

    /// The operands of an operator, as items: a list cannot contain operators on sets.
    fn parts(&self) -> String {
        match self {
            Set::Union(a, b) | Set::Minus(a, b) | Set::Times(a, b) => {
                format!("{}, {}", a.item(), b.item())
            }
            Set::Over(a, i) => format!("{}, {}", a.item(), atoms()[*i].0),
            Set::Power(i, p) => format!("({})^{p}", atoms()[*i].0),
            other => other.item(),
        }
    }

    /// The same set, written out, or why it is not.
    pub fn terms(&self) -> Result<BTreeSet<Term>, Wrong> {
        let made: BTreeSet<Term> = match self {
            Set::One(i) => [column(*i)].into(),
            Set::List(items) => all(items, Set::item_terms)?,
            Set::Union(a, b) => a.terms()?.union(&b.terms()?).cloned().collect(),
            Set::Minus(a, b) => minus(a.terms()?, &b.terms()?)?,
            Set::Times(a, b) => times(&a.terms()?, &b.terms()?)?,
            Set::Over(a, i) => times(&a.terms()?, &[column(*i).pow(-1.0)].into())?,
            Set::Power(i, p) => [column(*i).pow(f64::from(*p))].into(),
            Set::Poly(args, total) => monomials(args, total.1, *total)?,
            Set::Powers(args, p) => monomials(args, *p, (0, u32::MAX))?,
            Set::Fourier(i, n) => fourier(*i, *n),
        };
        if made.len() > MOST {
            Err(Wrong::Large)
        } else {
            Ok(made)
        }
    }

    fn item_terms(&self) -> Result<BTreeSet<Term>, Wrong> {
        match self {
            Set::Union(a, b) | Set::Minus(a, b) | Set::Times(a, b) => {
                Ok(a.item_terms()?.union(&b.item_terms()?).cloned().collect())
            }
            Set::Over(a, i) => {
                let mut all = a.item_terms()?;
                all.insert(column(*i));
                Ok(all)
            }
            other => other.terms(),
        }
    }
}

/// Why a set is not written out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrong {
    /// Too many terms for the naive side.
    Large,
    /// The language refuses it.
    Refused,
}

fn args(bytes: &mut Bytes, deep: usize) -> Vec<Set> {
    let count = bytes.within(1, 5);
    let nested = deep > 1 && bytes.rarely(8);
    let arg = |bytes: &mut Bytes| match nested {
        true => Set::to(bytes, deep - 2),
        false => Set::One(bytes.below(atoms().len())),
    };
    (0..count).map(|_| arg(bytes)).collect()
}

/// A written term as a column: its numerical factor is dropped.
fn column(i: usize) -> Term {
    atoms()[i].1.clone().into_term().1
}

fn all(
    sets: &[Set],
    terms: fn(&Set) -> Result<BTreeSet<Term>, Wrong>,
) -> Result<BTreeSet<Term>, Wrong> {
    let mut out = BTreeSet::new();
    for set in sets {
        out.extend(terms(set)?);
    }
    Ok(out)
}

fn minus(a: BTreeSet<Term>, b: &BTreeSet<Term>) -> Result<BTreeSet<Term>, Wrong> {
    if a.is_disjoint(b) && !b.contains(&Term::signal(TARGET)) {
        return Err(Wrong::Refused);
    }
    Ok(a.difference(b).cloned().collect())
}

fn times(a: &BTreeSet<Term>, b: &BTreeSet<Term>) -> Result<BTreeSet<Term>, Wrong> {
    if a.len() * b.len() > 4 * MOST {
        return Err(Wrong::Large);
    }
    Ok(a.iter().flat_map(|a| b.iter().map(|b| a.mul(b))).collect())
}

/// Products of powers of the arguments' terms, made one atom at a time; neither the target nor 1 is an atom.
fn monomials(args: &[Set], each: u32, total: (u32, u32)) -> Result<BTreeSet<Term>, Wrong> {
    let mut atoms = all(args, Set::item_terms)?;
    atoms.remove(&Term::signal(TARGET));
    atoms.remove(&Term::one());
    let mut made: BTreeSet<(u32, Term)> = [(0, Term::one())].into();
    for atom in &atoms {
        let mut next = BTreeSet::new();
        for (degree, term) in &made {
            for p in 0..=each.min(total.1 - degree) {
                next.insert((degree + p, term.mul(&atom.pow(f64::from(p)))));
            }
        }
        if next.len() > 4 * MOST {
            return Err(Wrong::Large);
        }
        made = next;
    }
    Ok(made
        .into_iter()
        .filter(|(degree, _)| *degree >= total.0)
        .map(|(_, t)| t)
        .collect())
}

fn fourier(i: usize, n: u32) -> BTreeSet<Term> {
    let of = |name: &str, k: u32| {
        let angle = atoms()[i].1.clone().scale(f64::from(k));
        Expr::call(Func::named(name).unwrap(), vec![angle])
            .into_term()
            .1
    };
    (1..=n)
        .flat_map(|k| ["sin", "cos"].map(|name| of(name, k)))
        .collect()
}
