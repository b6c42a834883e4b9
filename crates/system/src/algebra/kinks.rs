//! Kinks: where `abs`, `sign` and `step` are at zero, or `min` and `max` at a tie, and equations have no derivative.
//!
//! In: a form and a point. Out: each kink there, with the form on either side. Kinks whose sides agree, such as
//! `x*abs(x)` at zero, are listed too; the caller compares the sides.

use crate::algebra::thresholds::KINKS;
use std::collections::BTreeSet;

use crate::algebra::linearization::Point;
use crate::discovery::{Form, Row};
use sidc_lang::term::{Atom, Expr, Func, Signal};

/// A kink, and the sides that meet there.
#[derive(Clone, Debug)]
pub struct Kink {
    /// The call that has no derivative.
    pub call: Expr,
    pub sides: Vec<Side>,
}

/// The system on one side.
#[derive(Clone, Debug)]
pub struct Side {
    /// ±x, whichever is positive there; for `min` and `max` the argument that is taken.
    pub chosen: Expr,
    pub form: Form,
}

/// The kinks of all equations and outputs at the point, as far as their arguments do not contain unknowns.
pub fn kinks(form: &Form, point: &Point) -> Vec<Kink> {
    let mut calls = BTreeSet::new();
    let rows = form.rows.iter().map(|r| &r.right);
    for e in rows.chain(form.outputs.iter().map(|(_, e)| e)) {
        collect(e, &mut calls);
    }
    let at = |s: Signal| match form.unknowns.contains(&s) {
        true => f64::NAN,
        false => point.value(s),
    };
    let mut arguments = BTreeSet::new();
    let mut found = Vec::new();
    for (f, args) in calls {
        let choices = match (f.name, args.as_slice()) {
            ("abs" | "sign" | "step", [x])
                if x.eval(&at).abs() <= KINKS.at_kink && arguments.insert(x.clone()) =>
            {
                vec![x.clone(), x.clone().scale(-1.0)]
            }
            ("min" | "max", _) => tied(f, &args, &at),
            _ => continue,
        };
        if choices.len() > 1 && found.len() < KINKS.listed {
            found.push(kink(form, f, args, choices));
        }
    }
    found
}

fn collect(e: &Expr, calls: &mut BTreeSet<(Func, Vec<Expr>)>) {
    for (atom, _) in e.terms().flat_map(|(_, t)| t.factors()) {
        match atom {
            Atom::Signal(_) => {}
            Atom::Sum(inner) => collect(inner, calls),
            Atom::Call(f, args) => {
                args.iter().for_each(|a| collect(a, calls));
                if f.switches() {
                    calls.insert((*f, args.to_vec()));
                }
            }
        }
    }
}

/// The arguments of `min` or `max` that tie.
fn tied(f: Func, args: &[Expr], at: &impl Fn(Signal) -> f64) -> Vec<Expr> {
    let values: Vec<f64> = args.iter().map(|a| a.eval(at)).collect();
    let best = (f.eval)(&values);
    let near = |v: f64| (v - best).abs() <= KINKS.at_kink * best.abs().max(1.0);
    let each = args.iter().zip(&values).filter(|(_, v)| near(**v));
    each.map(|(a, _)| a.clone()).collect()
}

fn kink(form: &Form, f: Func, args: Vec<Expr>, choices: Vec<Expr>) -> Kink {
    let side = |chosen: &Expr| {
        let sign = if args.first() == Some(chosen) {
            1.0
        } else {
            -1.0
        };
        let swap = |atom: &Atom| match (atom, f.name) {
            (Atom::Call(g, a), "abs" | "sign" | "step") if a.as_ref() == args.as_slice() => {
                match g.name {
                    "abs" => Some(chosen.clone()),
                    "sign" => Some(Expr::number(sign)),
                    "step" => Some(Expr::number(0.5 + 0.5 * sign)),
                    _ => None,
                }
            }
            (Atom::Call(g, a), _) if *g == f && a.as_ref() == args.as_slice() => {
                Some(chosen.clone())
            }
            _ => None,
        };
        Side {
            form: rewritten_form(form, &swap),
            chosen: chosen.clone(),
        }
    };
    let sides = choices.iter().map(side).collect();
    Kink {
        sides,
        call: Expr::call(f, args),
    }
}

fn rewritten_form(form: &Form, swap: &impl Fn(&Atom) -> Option<Expr>) -> Form {
    let new = |e: &Expr| rewritten(e, swap);
    let mut out = form.clone();
    out.rows = (form.rows.iter())
        .map(|r| Row {
            right: new(&r.right),
            mass: r.mass.iter().map(new).collect(),
            force: new(&r.force),
        })
        .collect();
    for (_, e) in &mut out.outputs {
        *e = new(e);
    }
    out
}

/// The expression with some of its atoms replaced, at any depth.
fn rewritten(e: &Expr, swap: &impl Fn(&Atom) -> Option<Expr>) -> Expr {
    let of_atom = |atom: &Atom| match (swap(atom), atom) {
        (Some(new), _) => new,
        (None, Atom::Signal(s)) => Expr::signal(*s),
        (None, Atom::Sum(inner)) => rewritten(inner, swap),
        (None, Atom::Call(f, args)) => {
            Expr::call(*f, args.iter().map(|a| rewritten(a, swap)).collect())
        }
    };
    let of_term = |(weight, term): (f64, &sidc_lang::term::Term)| {
        let factors = term.factors().map(|(atom, p)| of_atom(atom).pow(p));
        factors.fold(Expr::number(weight), |all, f| all * f)
    };
    e.terms().map(of_term).sum()
}
