//! Whether a term is identical to a combination of others: x = x sin² + x cos².
//!
//! In: a term, the others. Out: yes or no, by least squares at random values of their signals; no data are used.

use nalgebra::{DMatrix, DVector};

use super::thresholds::IDENTITY_TEST;
use crate::SplitMix;
use sidc_lang::term::{Signal, SignalNames, Term};

/// Whether the term is a linear combination of the others at random values of all signals; unknown constants have one value throughout.
pub(crate) fn is_identity(term: &Term, others: &[Term], names: &impl SignalNames) -> bool {
    if others.is_empty() || others.len() > IDENTITY_TEST.max_terms {
        return false;
    }
    let mut signals: Vec<Signal> = Vec::new();
    for t in others.iter().chain([term]) {
        t.for_each_signal(&mut |s| signals.push(s));
    }
    signals.sort_unstable();
    signals.dedup();
    let signals: Vec<(Signal, bool)> = (signals.into_iter())
        .map(|s| (s, names.is_constant(s.var)))
        .collect();
    let residuals = IDENTITY_TEST
        .ranges
        .iter()
        .map(|range| residual(term, others, &signals, *range));
    let first = residuals.flatten().next();
    first.is_some_and(|residual| residual < IDENTITY_TEST.residual)
}

/// Whether `other` can write every law of the terms `found` in other words, whatever the values of the signals: each term that it
/// lacks is a combination of its own.
pub(crate) fn same_laws(found: &[Term], other: &[Term], names: &impl SignalNames) -> bool {
    let mut lacking = found.iter().filter(|t| !other.contains(t));
    lacking.all(|term| is_identity(term, other, names))
}

/// The relative residual of the term's least-squares fit by the others; `None` if a value is not finite. `signals`: rising, each with whether
/// it is a constant.
fn residual(
    term: &Term,
    others: &[Term],
    signals: &[(Signal, bool)],
    (low, high): (f64, f64),
) -> Option<f64> {
    let mut random = SplitMix::new(3);
    let mut draw = || low + (high - low) * random.unit();
    let constants: Vec<f64> = signals.iter().map(|_| draw()).collect();
    let points: Vec<Vec<f64>> = (0..IDENTITY_TEST.points)
        .map(|_| {
            let of = |((_, constant), value): (&(Signal, bool), &f64)| match constant {
                true => *value,
                false => draw(),
            };
            signals.iter().zip(&constants).map(of).collect()
        })
        .collect();
    let value = |t: &Term, point: &[f64]| {
        let at = |s: Signal| {
            signals
                .binary_search_by_key(&s, |(s, _)| *s)
                .ok()
                .and_then(|k| point.get(k).copied())
        };
        t.eval(&|s| at(s).unwrap_or(f64::NAN))
    };
    let column = |t: &Term| {
        let values = points.iter().map(|p| value(t, p));
        DVector::from_iterator(points.len(), values)
    };
    let target = column(term);
    let columns: Vec<DVector<f64>> = others.iter().map(column).collect();
    let finite = |v: &DVector<f64>| v.iter().all(|x| x.is_finite());
    if !finite(&target) || !columns.iter().all(finite) {
        return None;
    }
    let matrix = DMatrix::from_columns(&columns);
    let svd = matrix.clone().svd(true, true);
    let weights = svd.solve(&target, IDENTITY_TEST.singular).ok()?;
    let left = (&target - matrix * weights).norm();
    Some(left / target.norm().max(f64::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::{is_identity, same_laws};
    use sidc_lang::term::{Expr, Func, Signal, SignalNames, Term, VarId};

    /// x, and the constant q.
    struct Names;

    impl SignalNames for Names {
        fn variable(&self, _: VarId) -> &str {
            ""
        }

        fn is_constant(&self, var: VarId) -> bool {
            var == VarId(2)
        }
    }

    fn x() -> Signal {
        Signal::new(VarId(1))
    }

    fn of(function: &str, power: f64) -> Term {
        let call = Expr::call(Func::named(function).unwrap(), vec![Expr::signal(x())]);
        call.pow(power).into_term().1
    }

    #[test]
    fn identities_are_distinguished_from_approximations() {
        let (sine, cosine) = (of("sin", 2.0), of("cos", 2.0));
        assert!(is_identity(
            &Term::one(),
            &[sine.clone(), cosine.clone()],
            &Names
        ));
        assert!(!is_identity(&Term::signal(x()), &[of("sin", 1.0)], &Names));
        assert!(!is_identity(&Term::one(), &[sine], &Names));
        // Defined on one side only: 2 log x = log x².
        let square = Expr::call(
            Func::named("log").unwrap(),
            vec![Expr::signal(x()).pow(2.0)],
        );
        assert!(is_identity(
            &of("log", 1.0),
            &[square.into_term().1],
            &Names
        ));
        assert!(!is_identity(&Term::one(), &[], &Names));
    }

    /// x/(x + q) = 1 - q/(x + q) for every q, though not with the same q if q were a signal.
    #[test]
    fn a_constant_is_held() {
        let q = Expr::signal(Signal::new(VarId(2)));
        let inverse = (Expr::signal(x()) + q).pow(-1.0).into_term().1;
        let fraction = Term::signal(x()).mul(&inverse);
        let (found, other) = ([Term::one(), inverse.clone()], [Term::one(), fraction]);
        assert!(same_laws(&found, &other, &Names));
        assert!(!same_laws(&found, &[inverse, Term::signal(x())], &Names));
    }
}
