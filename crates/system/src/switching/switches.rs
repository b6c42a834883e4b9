//! The switches of a system: every function with a jump or a bend is rewritten with the value of its switch.
//!
//! In: expressions. Out: their guards, each once, and the expressions with σ in place of `sign(g)`, (1 + σ)/2 of `step(g)`, σ·g of
//! `abs(g)`; `min` and `max` are those of two, by the sign of the difference.

use super::modes::{Contact, Mode, Modes};
use sidc_lang::model::Reset;
use sidc_lang::term::{Atom, Expr, Func, Signal, Smoothness, Term, VarId};

/// Guards and the signals that stand for their switches.
#[derive(Clone, Debug, Default)]
pub struct Switches {
    /// Where each is zero, a law switches.
    pub guards: Vec<Expr>,
    /// Whether a law or a state jumps there, and a law does not only bend.
    pub jumps: Vec<bool>,
    /// What states do there.
    pub resets: Vec<ResetMap>,
    /// Where bodies that have struck each other stay together.
    pub contacts: Vec<Contact>,
}

/// States that jump where a guard leaves one of its sides.
#[derive(Clone, Debug, PartialEq)]
pub struct ResetMap {
    pub switch: usize,
    /// The side that it leaves.
    pub leaves: Mode,
    /// Each signal with its value after the jump.
    pub jumps: Vec<(Signal, Expr)>,
}

/// Functions that may have no value where their argument is continued across a bend.
fn has_domain(f: Func) -> bool {
    !f.domain.is_empty()
}

/// Whether an expression has one of these signals.
fn depends(e: &Expr, signals: &dyn Fn(Signal) -> bool) -> bool {
    let mut found = false;
    e.for_each_signal(&mut |s| found |= signals(s));
    found
}

/// Whether a term has such a call, within its arguments and sums too.
fn has_call(term: &Term, wanted: &dyn Fn(Func, &[Expr]) -> bool) -> bool {
    let within = |e: &Expr| e.terms().any(|(_, t)| has_call(t, wanted));
    term.factors().any(|(atom, _)| match atom {
        Atom::Signal(_) => false,
        Atom::Call(f, args) => wanted(*f, args) || args.iter().any(within),
        Atom::Sum(inner) => within(inner),
    })
}

impl Switches {
    /// The signal that stands for a switch: no declared variable leads time.
    pub fn signal(switch: usize) -> Signal {
        Signal::shifted(VarId::TIME, 1 + switch as i32)
    }

    /// Whether a term has a function that may switch.
    pub fn are_in(term: &Term) -> bool {
        has_call(term, &|f, _| f.switches())
    }

    /// Whether a term jumps where one of these signals passes a value.
    pub fn jumps_in(term: &Term, signals: &dyn Fn(Signal) -> bool) -> bool {
        has_call(term, &|f, args| {
            f.smoothness == Smoothness::Jumps && args.iter().any(|a| depends(a, signals))
        })
    }

    /// Whether a term jumps or bends where one of these signals passes a value.
    pub fn switch_in(term: &Term, signals: &dyn Fn(Signal) -> bool) -> bool {
        has_call(term, &|f, args| {
            f.switches() && args.iter().any(|a| depends(a, signals))
        })
    }

    pub fn len(&self) -> usize {
        self.guards.len()
    }

    pub fn is_empty(&self) -> bool {
        self.guards.is_empty()
    }

    /// Modes before any is decided: contacts are open.
    pub fn first_modes(&self) -> Modes {
        let mut modes = Modes(vec![Mode::Level; self.len()]);
        self.contacts
            .iter()
            .for_each(|c| modes.0[c.speed] = Mode::Idle);
        modes
    }

    /// The signals of all switches.
    pub fn signals(&self) -> Vec<Signal> {
        (0..self.len()).map(Switches::signal).collect()
    }

    /// The expression with its switches as signals; guards that are new are added. A guard with one of `excluded`, the rates that are
    /// solved for, stays a function: it has no value before these are known.
    pub fn rewritten(&mut self, e: &Expr, excluded: &[Signal]) -> Expr {
        self.sum(e, excluded, true)
    }

    fn sum(&mut self, e: &Expr, excluded: &[Signal], is_smooth: bool) -> Expr {
        let mut all = Vec::with_capacity(e.terms().len());
        for (weight, term) in e.terms() {
            all.push(self.product(term, excluded, is_smooth).scale(weight));
        }
        all.into_iter().sum()
    }

    fn product(&mut self, term: &Term, excluded: &[Signal], is_smooth: bool) -> Expr {
        let mut out = Expr::number(1.0);
        for (atom, power) in term.factors() {
            out = out * self.factor(atom, power, excluded, is_smooth);
        }
        out
    }

    fn factor(&mut self, atom: &Atom, power: f64, excluded: &[Signal], is_smooth: bool) -> Expr {
        let whole = power.fract() == 0.0 && power > 0.0;
        match atom {
            Atom::Signal(s) => Expr::signal(*s).pow(power),
            Atom::Sum(inner) => self.sum(inner, excluded, is_smooth && whole).pow(power),
            Atom::Call(f, args) if f.switches() => {
                self.switch(*f, args, power, excluded, is_smooth && whole)
            }
            Atom::Call(f, args) => {
                let is_smooth = is_smooth && !has_domain(*f);
                let args = args.iter().map(|a| self.sum(a, excluded, is_smooth));
                Expr::call(*f, args.collect()).pow(power)
            }
        }
    }

    fn switch(
        &mut self,
        f: Func,
        args: &[Expr],
        power: f64,
        excluded: &[Signal],
        is_smooth: bool,
    ) -> Expr {
        let as_written = || Expr::call(f, args.to_vec()).pow(power);
        if args.iter().any(|a| excluded.iter().any(|q| a.mentions(*q))) {
            return as_written();
        }
        let args: Vec<Expr> = args
            .iter()
            .map(|a| self.sum(a, excluded, is_smooth))
            .collect();
        // A switch within the argument of another is found first; one that depends on it stays as it is.
        let signals = self.signals();
        if args.iter().any(|a| signals.iter().any(|s| a.mentions(*s))) {
            return Expr::call(f, args).pow(power);
        }
        let odd = power.rem_euclid(2.0) == 1.0;
        let even = power.rem_euclid(2.0) == 0.0;
        match (f.name, args.as_slice()) {
            ("sign", [g]) => match self.side_of(g, true) {
                // The convex hull of two equal values is that value.
                _ if even => Expr::number(1.0),
                side if odd => side,
                side => side.pow(power),
            },
            ("step", [g]) => {
                let side = self.side_of(g, true);
                (Expr::number(1.0) + side).scale(0.5)
            }
            ("abs", [g]) => {
                let side = self.side_of(g, false);
                match is_smooth {
                    _ if even => g.clone().pow(power),
                    true => (side * g.clone()).pow(power),
                    false => as_written(),
                }
            }
            ("min" | "max", [first, rest @ ..]) => {
                let toward = if f.name == "max" { 0.5 } else { -0.5 };
                let mut best = first.clone();
                let mut is_whole = is_smooth;
                for next in rest {
                    let apart = best.clone() - next.clone();
                    if signals_of(&apart, self.len()) {
                        is_whole = false;
                        break;
                    }
                    let side = self.side_of(&apart, false);
                    best = (best + next.clone()).scale(0.5) + (side * apart).scale(toward);
                }
                if is_whole {
                    best.pow(power)
                } else {
                    as_written()
                }
            }
            _ => as_written(),
        }
    }

    /// The multiple of a guard that is listed, and what the guard is of it; `None` for zero.
    pub fn canonical(guard: &Expr) -> Option<(f64, Expr)> {
        let (lead, _) = guard.terms().next()?;
        Some((lead, guard.clone().scale(1.0 / lead)))
    }

    /// Adds the guards at which states jump. A condition that never changes is left out.
    pub fn add_resets(&mut self, resets: &[Reset]) {
        for reset in resets {
            let guard = reset.condition.guard();
            if guard.as_number().is_some() {
                continue;
            }
            let Some((lead, canonical)) = Switches::canonical(&guard) else {
                continue;
            };
            let switch = self.place_of(canonical);
            self.jumps[switch] = true;
            self.resets.push(ResetMap {
                switch,
                leaves: Mode::of(lead),
                jumps: reset.jumps.clone(),
            });
        }
    }

    /// σ of a guard, with the sign of its multiple that is listed.
    fn side_of(&mut self, guard: &Expr, jumps: bool) -> Expr {
        if let Some(value) = guard.as_number() {
            return Expr::number(if value == 0.0 { 0.0 } else { value.signum() });
        }
        let Some((lead, canonical)) = Switches::canonical(guard) else {
            return Expr::zero();
        };
        let place = self.place_of(canonical);
        self.jumps[place] |= jumps;
        Expr::signal(Switches::signal(place)).scale(lead.signum())
    }

    /// The place of a guard, which is added if it is new.
    fn place_of(&mut self, canonical: Expr) -> usize {
        let known = self.guards.iter().position(|g| *g == canonical);
        known.unwrap_or_else(|| {
            self.guards.push(canonical);
            self.jumps.push(false);
            self.guards.len() - 1
        })
    }
}

fn signals_of(e: &Expr, count: usize) -> bool {
    (0..count).any(|k| e.mentions(Switches::signal(k)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: Signal = Signal::new(VarId(1));
    const V: Signal = Signal::derivative(VarId(1), 1);

    fn call(name: &str, args: impl Into<Vec<Expr>>) -> Expr {
        Expr::call(Func::named(name).unwrap(), args.into())
    }

    /// The rewritten expression has the old value on every side of every guard.
    #[test]
    fn values_stay_on_all_sides() {
        let (x, v) = (Expr::signal(X), Expr::signal(V));
        let one = Expr::number(1.0);
        let cases = [
            call("sign", [v.clone()]),
            call("sign", [v.clone().scale(-2.0)]),
            call("sign", [v.clone()]).pow(2.0) * x.clone(),
            call("sign", [v.clone()]).pow(3.0),
            call("step", [x.clone() - one.clone()]).pow(2.0) * v.clone(),
            call("abs", [v.clone()]) * v.clone(),
            call("abs", [v.clone()]).pow(0.5) * call("sign", [v.clone()]),
            call("abs", [x.clone() + v.clone()]).pow(3.0),
            call("min", [x.clone(), v.clone()]),
            call("max", [x.clone(), v.clone(), one.clone()]),
            call("sin", [call("abs", [x.clone()])]),
            call("sqrt", [call("abs", [x.clone()])]),
            call("sign", [call("abs", [x.clone()]) - one.clone()]),
            one.clone() / call("max", [x.clone(), one.clone()]),
        ];
        for e in cases {
            let mut switches = Switches::default();
            let smooth = switches.rewritten(&e, &[]);
            assert!(!switches.is_empty(), "{e:?}");
            for (a, b) in [
                (0.3, 0.7),
                (-0.4, 1.7),
                (1.2, -0.5),
                (-2.0, -3.0),
                (2.5, 1.1),
            ] {
                let at = |s: Signal| if s == X { a } else { b };
                let with_sides = |s: Signal| match s.shift {
                    0 => at(s),
                    k => switches.guards[k as usize - 1].eval(&at).signum(),
                };
                let (old, new) = (e.eval(&at), smooth.eval(&with_sides));
                assert!((old - new).abs() < 1e-14, "{e:?} at {a} {b}: {old} {new}");
            }
        }
    }

    #[test]
    fn multiples_share_a_guard_and_rates_have_none() {
        let mut switches = Switches::default();
        let v = Expr::signal(V);
        switches.rewritten(&call("sign", [v.clone()]), &[]);
        switches.rewritten(&call("abs", [v.clone().scale(-3.0)]), &[]);
        assert_eq!((switches.len(), switches.jumps.clone()), (1, vec![true]));
        let rate = call("sign", [v.clone()]);
        let mut none = Switches::default();
        assert_eq!(none.rewritten(&rate, &[V]), rate);
        assert!(none.is_empty());
    }
}
