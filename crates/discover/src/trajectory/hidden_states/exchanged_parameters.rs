//! Laws with the same terms that follow the readings as well, found by exchanging two time constants.
//!
//! In: a problem, the fit to it. Out: another fit, or nothing. Linearised at the fit nothing shows of them: they lie elsewhere. Where a hidden state z drives a measured x, dx = c + a x + g z and dz = b z + …,
//! the input reaches x through two first-order lags, and their order does not show: z + ((a − b) x + c (1 − b/a))/g obeys the same laws with a and b
//! exchanged. Whatever else stands in the laws, a fit from there decides.

use super::hidden_laws::hidden_laws;
use super::start::tightened;
use super::thresholds::HIDDEN;
use crate::trajectory::likelihood::{Fit, fit};
use crate::trajectory::model::{Law, LinearizationPoint, Problem};
use crate::trajectory::search::{
    FittedConstants, Found, Parameter, SoughtConstant, fit_constants, last_criterion,
    with_constant_values,
};
use sidc_lang::term::{Signal, Term};
use sidc_progress::Observer;

/// The first such fit, with clearly other time constants, whose criterion is at most `tie` more.
pub(crate) fn exchanged_lags(
    problem: &Problem,
    found: &Found,
    tie: f64,
    observer: &mut dyn Observer,
) -> Option<Fit> {
    let criterion = last_criterion(problem, found.inefficiency);
    let (_, sought) = hidden_laws(problem);
    let pairs = sought
        .iter()
        .flat_map(|h| (0..problem.system.laws.len()).map(move |l| (*h, l)));
    let starts = pairs.filter_map(|(h, l)| exchanged(problem, &found.best.point, (h, l)));
    let starts: Vec<LinearizationPoint> = starts.collect();
    starts.into_iter().find_map(|start| {
        let twin = fit(problem, start, &criterion, f64::INFINITY, observer)?;
        let tied = twin.converged && twin.value < found.best.value + tie;
        (tied && has_other_lags(problem, &twin.point, &found.best.point)).then_some(twin)
    })
}

/// Whether some law has clearly another time constant, the coefficient of its own state. A fit may come back to where it was, but for an offset
/// of the hidden state.
fn has_other_lags(problem: &Problem, one: &LinearizationPoint, other: &LinearizationPoint) -> bool {
    let system = &problem.system;
    let lag = |point: &LinearizationPoint, law: &Law| {
        let own = Term::signal(system.states[law.state]);
        let mut active = point.active().into_iter();
        let lag = active.find(|(j, _)| law.columns.contains(j) && system.columns[*j] == own);
        lag.map_or(0.0, |(_, a)| a)
    };
    let mut pairs = system
        .laws
        .iter()
        .map(|law| (lag(one, law), lag(other, law)));
    pairs.any(|(a, b)| (a - b).abs() > HIDDEN.distinct * b.abs())
}

/// The point with the time constants of the hidden law `h` and of law `l` exchanged.
fn exchanged(
    problem: &Problem,
    point: &LinearizationPoint,
    (h, l): (usize, usize),
) -> Option<LinearizationPoint> {
    let system = &problem.system;
    let (hidden, other) = (&system.laws[h], &system.laws[l]);
    if h == l || hidden.target.der != 1 || other.target.der != 1 {
        return None;
    }
    let z = Signal::new(hidden.target.var);
    let place = |law: usize, term: &Term| {
        let own = &system.laws[law].columns;
        let mut support = point.support.iter();
        support.position(|j| own.contains(j) && system.columns[*j] == *term)
    };
    let of = |place: usize| point.coefficients[place];
    let own = place(h, &Term::signal(z))?;
    let measured = place(l, &Term::signal(system.states[other.state]))?;
    let drive = of(place(l, &Term::signal(z))?);
    let offset = place(l, &Term::one());
    let (a, b) = (of(measured), of(own));
    let mut moved = point.clone();
    moved.coefficients[measured] = b;
    moved.coefficients[own] = a;
    let c = offset.map_or(0.0, of);
    if let Some(place) = offset {
        moved.coefficients[place] = c * b / a;
    }
    let n = problem.states();
    for path in &mut moved.paths {
        for row in path.chunks_exact_mut(n) {
            row[hidden.state] += ((a - b) * row[other.state] + c * (1.0 - b / a)) / drive;
        }
    }
    let finite = moved.coefficients.iter().all(|x| x.is_finite());
    finite.then_some(moved)
}

/// A fit with the same terms but clearly other constants whose criterion is at most `tie` more, if there is one. It starts from the sizes
/// of an unknown constant and another parameter exchanged. Example: from the number of infectious people alone, the rates of becoming
/// infectious and of recovering cannot be told apart.
pub(crate) fn exchanged_constants(
    problem: &Problem,
    found: &Found,
    constants: &[SoughtConstant],
    tie: f64,
    observer: &mut dyn Observer,
) -> Option<FittedConstants> {
    let active = found.best.point.active();
    let free = |k: usize| constants[k].range.0 < constants[k].range.1;
    let places = (0..constants.len()).filter(|k| free(*k));
    let pairs = places.flat_map(|k| {
        let further = (k + 1..constants.len()).filter(|other| free(*other));
        let coefficients = active.iter().map(|(j, _)| Parameter::Coefficient(*j));
        let others = further.map(Parameter::Constant).chain(coefficients);
        others.map(move |other| (k, other))
    });
    let starts =
        pairs.filter_map(|(k, other)| with_exchanged(&found.best.point, constants, (k, other)));
    let starts: Vec<_> = starts.take(HIDDEN.exchanges).collect();
    starts.into_iter().find_map(|(constants_there, point)| {
        let there = with_constant_values(problem, &constants_there);
        let start = tightened(&there, point, f64::INFINITY, observer)?;
        let twin = fit_constants(
            &there,
            &start,
            &constants_there,
            found.inefficiency,
            observer,
        )?;
        let near = |(a, b): (&SoughtConstant, &SoughtConstant)| {
            (a.value - b.value).abs() <= HIDDEN.distinct * b.value.abs()
        };
        let same = twin.constants.iter().zip(constants).all(near);
        (!same && twin.value < found.best.value + tie).then_some(twin)
    })
}

/// Constants and a point in which a constant and another parameter have exchanged their sizes; `None` where a range forbids it.
fn with_exchanged(
    point: &LinearizationPoint,
    constants: &[SoughtConstant],
    (k, other): (usize, Parameter),
) -> Option<(Vec<SoughtConstant>, LinearizationPoint)> {
    let (mut constants, mut point) = (constants.to_vec(), point.clone());
    let own = constants[k].value;
    let theirs = match other {
        Parameter::Constant(m) => {
            let theirs = constants[m].value;
            constants[m].value = theirs.signum() * own.abs();
            theirs
        }
        Parameter::Coefficient(j) => {
            let place = point.support.iter().position(|column| *column == j)?;
            let theirs = point.coefficients[place];
            point.coefficients[place] = theirs.signum() * own.abs();
            theirs
        }
    };
    constants[k].value = own.signum() * theirs.abs();
    let allowed = |c: &SoughtConstant| (c.range.0..=c.range.1).contains(&c.value);
    constants.iter().all(allowed).then_some((constants, point))
}
