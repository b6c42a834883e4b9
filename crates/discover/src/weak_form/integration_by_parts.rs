//! Integration by parts of terms with high derivatives: one time derivative is moved onto the test function.
//!
//! In: a term, and the sources of its signals. Out: the same under the integral, with lower derivatives. Sees no data.

use sidc_lang::term::{Atom, Expr, Signal, Term, VarId};

use super::signal_sources::{EquationSignals, SignalSource};

/// ∫ψ T dt = −∫ψ′ `moved` dt − ∫ψ `rest` dt for every ψ that ends at zero.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ByParts {
    pub moved: Term,
    pub rest: Expr,
}

/// T = f·s, linear in the highest derivative s of T: T = d/dt(f·s⁻) − s⁻·df/dt with s⁻ the next lower derivative, df/dt by the chain
/// rule. `None` if df/dt contains derivatives as high as s, if an input would be differentiated, or if T has no derivative.
pub(super) fn integrate_by_parts(term: &Term, sources: &EquationSignals) -> Option<ByParts> {
    let mut all = Vec::new();
    term.for_each_signal(&mut |s| all.push(s));
    let highest = all.iter().filter_map(|s| order(*s, sources)).max()?;
    if highest == 0 {
        return None;
    }
    let top = *all.iter().find(|s| order(**s, sources) == Some(highest))?;
    let is_top = |atom: &Atom| matches!(atom, Atom::Signal(s) if *s == top);
    let linear = term
        .factors()
        .any(|(atom, power)| is_top(atom) && power == 1.0);
    let factor = term.part(|atom| !is_top(atom));
    if !linear || factor.mentions(top) {
        return None;
    }
    let below = Signal {
        der: top.der - 1,
        ..top
    };
    let mut signals = Vec::new();
    factor.for_each_signal(&mut |s| signals.push(s));
    signals.sort_unstable();
    signals.dedup();
    let mut rest = Expr::zero();
    for s in signals {
        let rate = match (s.var, order(s, sources)) {
            (VarId::TIME, _) => Expr::number(1.0),
            (_, Some(order)) if order + 1 < highest => Expr::signal(Signal {
                der: s.der + 1,
                ..s
            }),
            // The rate would be as high a derivative as the one that is lowered.
            _ => return None,
        };
        rest = rest + distribute(factor.derivative(s), &Expr::signal(below), &rate);
    }
    Some(ByParts {
        moved: factor.mul(&Term::signal(below)),
        rest,
    })
}

/// Order of derivative above the measured record; `None` for inputs, parameters and time.
fn order(s: Signal, sources: &EquationSignals) -> Option<usize> {
    sources.signals.iter().find_map(|(r, source)| match source {
        SignalSource::Smooth { order, .. } if *r == s => Some(*order),
        _ => None,
    })
}

/// Every summand times both factors, multiplied out.
fn distribute(sum: Expr, a: &Expr, b: &Expr) -> Expr {
    let product =
        |(weight, term): (f64, &Term)| Expr::from((weight, term.clone())) * a.clone() * b.clone();
    sum.terms().map(product).fold(Expr::zero(), |s, t| s + t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::Func;

    const X: VarId = VarId(1);
    const INPUT: VarId = VarId(2);

    fn sources() -> EquationSignals {
        let smooth = |order: u8| {
            let order_of = usize::from(order);
            let source = SignalSource::Smooth {
                record: 0,
                order: order_of,
            };
            (Signal::derivative(X, order), source)
        };
        EquationSignals {
            records: vec![Signal::new(X)],
            signals: vec![
                smooth(0),
                smooth(1),
                smooth(2),
                (Signal::new(INPUT), SignalSource::Held),
            ],
            target: (0, 2),
        }
    }

    fn x(der: u8) -> Expr {
        Expr::signal(Signal::derivative(X, der))
    }

    fn call(name: &str, e: Expr) -> Expr {
        Expr::call(Func::named(name).unwrap(), vec![e])
    }

    fn lowered(e: Expr) -> Option<ByParts> {
        integrate_by_parts(&e.into_term().1, &sources())
    }

    #[test]
    fn a_second_derivative_times_a_function_of_position() {
        let l = lowered(x(2) * call("cos", x(0))).unwrap();
        assert_eq!(l.moved, (x(1) * call("cos", x(0))).into_term().1);
        assert_eq!(l.rest, (x(1).pow(2.0) * call("sin", x(0))).scale(-1.0));
    }

    #[test]
    fn bare_derivatives_leave_nothing_behind() {
        let l = lowered(x(1)).unwrap();
        assert_eq!((l.moved, l.rest), (x(0).into_term().1, Expr::zero()));
    }

    #[test]
    fn what_would_need_the_same_derivative_again_stays() {
        for e in [
            x(1) * call("cos", x(0)),
            x(2) * x(1),
            x(2).pow(2.0),
            x(0),
            x(2) * Expr::signal(Signal::new(INPUT)),
        ] {
            assert_eq!(lowered(e), None);
        }
    }
}
