//! Whether some terms are another one in other words, whatever the data: x and x sin² + x cos².
//!
//! In: a term, those that stand in for it. Out: yes or no, by trying at random values of their signals.

use nalgebra::{DMatrix, DVector};

use crate::SplitMix;
use sidc_lang::term::{Signal, Term};

/// Values tried.
const POINTS: usize = 40;
/// Most terms of one in other words.
const MOST: usize = 6;
/// Relative rest below which it is rounding.
const ROUNDING: f64 = 1e-9;
/// Where values are drawn: anywhere, or where roots and logarithms are defined.
const RANGES: [(f64, f64); 2] = [(-2.0, 2.0), (0.3, 2.0)];

/// True if the term is a combination of the others at random values of all signals.
pub(super) fn identical(term: &Term, others: &[Term]) -> bool {
    if others.is_empty() || others.len() > MOST {
        return false;
    }
    let mut signals: Vec<Signal> = Vec::new();
    for t in others.iter().chain([term]) {
        t.for_each_signal(&mut |s| signals.push(s));
    }
    signals.sort_unstable();
    signals.dedup();
    let tried = RANGES
        .iter()
        .map(|range| rest(term, others, &signals, *range));
    tried.flatten().next().is_some_and(|rest| rest < ROUNDING)
}

/// What the best combination of the others leaves of the term, relative; `None` where some value is not finite.
fn rest(term: &Term, others: &[Term], signals: &[Signal], (low, high): (f64, f64)) -> Option<f64> {
    let mut random = SplitMix::new(3);
    let points: Vec<Vec<f64>> = (0..POINTS)
        .map(|_| {
            signals
                .iter()
                .map(|_| low + (high - low) * random.unit())
                .collect()
        })
        .collect();
    let value = |t: &Term, point: &[f64]| {
        let at = |s: Signal| {
            signals
                .binary_search(&s)
                .ok()
                .and_then(|k| point.get(k).copied())
        };
        t.eval(&|s| at(s).unwrap_or(f64::NAN))
    };
    let column = |t: &Term| DVector::from_iterator(POINTS, points.iter().map(|p| value(t, p)));
    let target = column(term);
    let columns: Vec<DVector<f64>> = others.iter().map(column).collect();
    let finite = |v: &DVector<f64>| v.iter().all(|x| x.is_finite());
    if !finite(&target) || !columns.iter().all(finite) {
        return None;
    }
    let matrix = DMatrix::from_columns(&columns);
    let weights = matrix.clone().svd(true, true).solve(&target, 1e-12).ok()?;
    let left = (&target - matrix * weights).norm();
    Some(left / target.norm().max(f64::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::identical;
    use sidc_lang::term::{Expr, Func, Signal, Term, VarId};

    fn x() -> Signal {
        Signal::new(VarId(1))
    }

    fn of(function: &str, power: f64) -> Term {
        let call = Expr::call(Func::named(function).unwrap(), vec![Expr::signal(x())]);
        call.pow(power).into_term().1
    }

    #[test]
    fn sums_that_are_the_same_everywhere_are_told_from_those_that_are_near() {
        let (sine, cosine) = (of("sin", 2.0), of("cos", 2.0));
        assert!(identical(&Term::one(), &[sine.clone(), cosine.clone()]));
        assert!(!identical(&Term::signal(x()), &[of("sin", 1.0)]));
        assert!(!identical(&Term::one(), &[sine]));
        // Defined on one side only: 2 log x = log x².
        let square = Expr::call(
            Func::named("log").unwrap(),
            vec![Expr::signal(x()).pow(2.0)],
        );
        assert!(identical(&of("log", 1.0), &[square.into_term().1]));
        assert!(!identical(&Term::one(), &[]));
    }
}
