//! Which equation should give which highest derivative.
//!
//! In: coupled laws on rows. Out: the condition number of their mass matrix, each row divided by the coefficient of its own target, and an
//! assignment of targets to laws for which it is clearly better. Never changes an equation.

use nalgebra::DMatrix;

use crate::relations::coupled_laws::Coupled;
use crate::relations::multiples::Law;
use crate::relations::thresholds::TARGETS;
use crate::statistics::rms;
use sidc_data::median;
use sidc_lang::term::{Expr, Term};
use sidc_system::discovery::{BetterTargets, TargetChoice, WrittenLaw};

/// The mass matrix on the rows, in units of the unknowns' sizes: entries by law, unknown and row.
type Mass = Vec<Vec<Vec<f64>>>;

/// The condition of the present assignment, and a better one; `None` where the mass matrix is not finite.
pub(super) fn target_choice(coupled: &Coupled) -> Option<TargetChoice> {
    let mass = mass(coupled);
    let n = mass.len();
    let present: Vec<usize> = (0..n).collect();
    let condition = condition(&mass, &present)?;
    let others = match n <= TARGETS.all {
        true => permutations(n),
        false => swaps(n),
    };
    let allowed = |order: &Vec<usize>| {
        let pivots = order.iter().enumerate();
        let mut moved = pivots.filter(|(i, j)| i != *j);
        *order != present && moved.all(|(i, j)| divides(&mass, i, *j))
    };
    let others: Vec<Vec<usize>> = others.into_iter().filter(allowed).collect();
    let judged = others
        .iter()
        .filter_map(|o| Some((self::condition(&mass, o)?, o)));
    let best = judged.min_by(|a, b| a.0.total_cmp(&b.0));
    let better = best.filter(|(c, _)| c * TARGETS.better <= condition);
    Some(TargetChoice {
        condition,
        assignments: others.len() + 1,
        better: better.and_then(|(condition, order)| {
            let laws = (0..n).map(|i| solved(coupled, i, *order.get(i)?));
            Some(BetterTargets {
                condition,
                laws: laws.collect::<Option<Vec<WrittenLaw>>>()?,
            })
        }),
    })
}

fn mass(coupled: &Coupled) -> Mass {
    let sizes: Vec<f64> = (coupled.form.unknowns.iter())
        .map(|u| rms(&coupled.rows.values_of(&Expr::signal(*u))))
        .collect();
    let entry = |(m, size): (&Expr, &f64)| -> Vec<f64> {
        let values = coupled.rows.values_of(m);
        values.into_iter().map(|v| v * size).collect()
    };
    let rows = coupled.form.rows.iter();
    rows.map(|r| r.mass.iter().zip(&sizes).map(entry).collect())
        .collect()
}

/// The median condition along the rows, law `i` divided by the coefficient of unknown `order[i]`.
fn condition(mass: &Mass, order: &[usize]) -> Option<f64> {
    let n = mass.len();
    let rows = mass.first()?.first()?.len();
    let at = |i: usize, j: usize, row: usize| {
        let entry = mass.get(i).and_then(|m| m.get(j)).and_then(|v| v.get(row));
        entry.copied().unwrap_or(f64::NAN)
    };
    let of_row = |row: usize| {
        let pivot = |i: usize| order.get(i).map_or(f64::NAN, |j| at(i, *j, row));
        let m = DMatrix::from_fn(n, n, |i, j| at(i, j, row) / pivot(i));
        let finite = m.iter().all(|x| x.is_finite());
        finite.then(|| {
            let values = m.singular_values();
            match values.min() > 0.0 {
                true => values.max() / values.min(),
                false => f64::MAX,
            }
        })
    };
    let mut all: Vec<f64> = (0..rows).filter_map(of_row).collect();
    median(&mut all)
}

/// Whether a law may be divided by the coefficient of an unknown: it keeps its sign, well away from zero.
fn divides(mass: &Mass, law: usize, unknown: usize) -> bool {
    let entry = mass.get(law).and_then(|m| m.get(unknown));
    entry.is_some_and(|values| {
        let least = TARGETS.divisor * rms(values);
        let sign = values.first().map_or(0.0, |v| v.signum());
        least > 0.0 && values.iter().all(|v| v * sign >= least)
    })
}

/// All orders of 0, 1, … n − 1.
fn permutations(n: usize) -> Vec<Vec<usize>> {
    (0..n).fold(vec![Vec::new()], |shorter, next| {
        let longer = shorter.iter().flat_map(|order: &Vec<usize>| {
            (0..=order.len()).map(move |place| {
                let mut order = order.clone();
                order.insert(place, next);
                order
            })
        });
        longer.collect()
    })
}

/// All orders with one pair exchanged.
fn swaps(n: usize) -> Vec<Vec<usize>> {
    let pairs = (0..n).flat_map(|a| (0..a).map(move |b| (a, b)));
    let swapped = |(a, b)| {
        let mut order: Vec<usize> = (0..n).collect();
        order.swap(a, b);
        order
    };
    pairs.map(swapped).collect()
}

/// Law `i` solved for unknown `j`.
fn solved(coupled: &Coupled, i: usize, j: usize) -> Option<WrittenLaw> {
    let unknown = Term::signal(*coupled.form.unknowns.get(j)?);
    let by = coupled.form.rows.get(i)?.mass.get(j)?;
    let own = |t: &Term| t.mul(&unknown.pow(-1.0));
    let law: &Law = coupled.laws.get(i)?;
    let among = |t: &Term| by.terms().any(|(_, b)| *b == own(t));
    let right = law.iter().filter(|(_, t)| !among(t));
    let divided = right.map(|(a, t)| Expr::from((-a, t.clone())) / by.clone());
    let sum: Expr = divided.sum();
    let right: Law = sum.terms().map(|(a, t)| (a, t.clone())).collect();
    Some(coupled.written(&unknown, &right))
}
