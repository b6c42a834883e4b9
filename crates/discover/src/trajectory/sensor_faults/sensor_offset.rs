//! A constant offset of a sensor as a rival of terms: laws about x − b have fewer of them.
//!
//! In: a problem and the fit of a support. Out: the offset of one state that makes two terms superfluous, or one that is no constant, if there is one.
//! Candidates for b come from a term and its derivative by the state: φ(x − b) = φ(x) − b φ′(x) + ….

use crate::trajectory::likelihood::{Fit, PenalizedLikelihood, fit};
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::search::final_criterion;
use crate::trajectory::thresholds::OFFSETS;
use sidc_lang::term::{Expr, Signal, Term};
use sidc_progress::Observer;

/// An offset that makes terms superfluous.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorOffset {
    /// The state that the sensor measures.
    pub signal: Signal,
    /// Reading less truth, in its units.
    pub value: f64,
    /// Columns that are superfluous with it.
    pub terms: Vec<usize>,
    /// Decrease of the criterion, the offset paid for as a term.
    pub gain: f64,
}

/// The offset that gains most.
pub fn find_sensor_offset(
    problem: &Problem,
    found: &Fit,
    observer: &mut dyn Observer,
) -> Option<SensorOffset> {
    let criterion = final_criterion(problem);
    let mut best: Option<SensorOffset> = None;
    for state in 0..problem.states() {
        let signal = problem.system.states[state];
        if signal.der > 0
            || problem
                .records
                .iter()
                .all(|r| r.measured[state].iter().all(|x| x.is_nan()))
        {
            continue;
        }
        for (value, column) in candidates(problem, found, signal) {
            if !observer.go_on() {
                return best;
            }
            let trial = OffsetTrial {
                problem,
                state,
                criterion: &criterion,
                hopeless: found.value + OFFSETS.hopeless * criterion.penalty,
            };
            let Some((value, fitted)) = trial.fit_and_prune(value, (found, column), observer)
            else {
                continue;
            };
            let gain = found.value - fitted.value - criterion.penalty;
            let gone = |j: &&usize| !fitted.support().contains(j);
            let terms: Vec<usize> = found.support().iter().filter(gone).copied().collect();
            let before = best.as_ref().map_or(-OFFSETS.as_good, |b| b.gain);
            if explains(problem, &terms) && gain > before {
                best = Some(SensorOffset {
                    signal,
                    value,
                    terms,
                    gain,
                });
            }
        }
    }
    best
}

/// Whether the terms that an offset makes superfluous are evidence for it. A constant term alone is none: it only says where zero is, and
/// both laws hold. Any other single term is: offset and term are one number each, and a shifted zero is the simpler cause.
fn explains(problem: &Problem, terms: &[usize]) -> bool {
    let constant = |j: &usize| problem.system.columns[*j].is_one();
    terms.len() >= OFFSETS.min_terms || terms.iter().any(|j| !constant(j))
}

/// Offsets that would explain a term as the derivative of another, each with that term.
fn candidates(problem: &Problem, found: &Fit, signal: Signal) -> Vec<(f64, usize)> {
    let system = &problem.system;
    let mut all: Vec<(f64, f64, usize)> = Vec::new();
    let terms = found.support().iter().zip(found.coefficients());
    for ((j, a), variance) in terms.clone().zip(&found.variances) {
        let slope = Expr::from(system.columns[*j].clone()).derivative(signal);
        let slopes: Vec<(f64, &Term)> = slope.terms().collect();
        let [(factor, term)] = slopes[..] else {
            continue;
        };
        let law = system.law_of(*j);
        let same = |k: &usize| system.law_of(*k) == law && system.columns[*k] == *term;
        if let Some((k, b)) = terms.clone().find(|(k, _)| same(k)) {
            let value = turned(
                -b / (a * factor),
                slope_of_slope(&system.columns[*j], signal),
            );
            all.push((variance.sqrt() / a.abs(), value, *k));
        }
    }
    // Terms other than the constant first, and among them those with the smallest relative standard error.
    let constant = |k: usize| system.columns[k].is_one();
    all.sort_by(|x, y| (constant(x.2).cmp(&constant(y.2))).then(x.0.total_cmp(&y.0)));
    let mut out: Vec<(f64, usize)> = Vec::new();
    for (_, value, column) in all {
        let near = |(v, _): &(f64, usize)| (v - value).abs() < OFFSETS.same * value.abs();
        if value.is_finite()
            && value != 0.0
            && !out.iter().any(near)
            && out.len() < OFFSETS.max_candidates
        {
            out.push((value, column));
        }
    }
    out
}

/// The factor c of φ″ = c φ; 0 if there is none, as for powers, whose series ends.
fn slope_of_slope(term: &Term, signal: Signal) -> f64 {
    let slope = Expr::from(term.clone()).derivative(signal);
    let second = slope.derivative(signal);
    let terms: Vec<(f64, &Term)> = second.terms().collect();
    match terms[..] {
        [(c, own)] if own == term => c,
        _ => 0.0,
    }
}

/// The offset whose first-order value is `value`, where φ″ = c φ: φ(x − b) is φ cos(ωb) − φ′ sin(ωb)/ω with ω² = −c.
fn turned(value: f64, c: f64) -> f64 {
    let omega = c.abs().sqrt();
    match c {
        c if c < 0.0 => (omega * value).atan() / omega,
        c if c > 0.0 && (omega * value).abs() < 1.0 => (omega * value).atanh() / omega,
        _ => value,
    }
}

/// Fits with different offsets of one state's sensor.
struct OffsetTrial<'a> {
    problem: &'a Problem,
    state: usize,
    criterion: &'a PenalizedLikelihood,
    /// Criterion above which a fit is given up.
    hopeless: f64,
}

impl OffsetTrial<'_> {
    /// Fits the offset without one term, then drops the weakest terms as long as the criterion falls.
    fn fit_and_prune(
        &self,
        value: f64,
        (found, without): (&Fit, usize),
        observer: &mut dyn Observer,
    ) -> Option<(f64, Fit)> {
        let start = self.moved(&found.point, value);
        let (mut value, mut fitted) = self.minimise(value, dropped(&start, without), observer)?;
        loop {
            let weak = |i: &usize| {
                let error = fitted.variances[*i].sqrt();
                error > OFFSETS.weak * fitted.coefficients()[*i].abs()
            };
            let strength = |i: &usize| fitted.coefficients()[*i].powi(2) / fitted.variances[*i];
            let mut order: Vec<usize> = (0..fitted.support().len()).filter(weak).collect();
            order.sort_by(|i, j| strength(i).total_cmp(&strength(j)));
            let next = order.first().and_then(|i| {
                let column = fitted.support()[*i];
                self.minimise(value, dropped(&fitted.point, column), observer)
            });
            match next.filter(|(_, f)| f.value < fitted.value && !f.support().is_empty()) {
                Some(better) => (value, fitted) = better,
                None => return Some((value, fitted)),
            }
        }
    }

    /// Minimises the criterion over the offset by successive parabolic interpolation.
    fn minimise(
        &self,
        value: f64,
        start: LinearizationPoint,
        observer: &mut dyn Observer,
    ) -> Option<(f64, Fit)> {
        let mut at = |v: f64, from: &LinearizationPoint, before: f64| {
            let problem = self.shifted(v);
            fit(
                &problem,
                self.moved(from, v - before),
                self.criterion,
                self.hopeless,
                observer,
            )
        };
        let mut middle = at(value, &start, value).filter(|f| f.value < self.hopeless)?;
        let mut value = value;
        let mut reach = OFFSETS.first_step * value.abs();
        for _ in 0..OFFSETS.max_parabolas {
            let left = at(value - reach, &middle.point, value)?;
            let right = at(value + reach, &middle.point, value)?;
            let (l, m, r) = (left.value, middle.value, right.value);
            let bend = l - 2.0 * m + r;
            let step = match bend > 0.0 {
                true => (0.5 * reach * (l - r) / bend)
                    .clamp(-OFFSETS.max_move * reach, OFFSETS.max_move * reach),
                false => reach.copysign(l - r),
            };
            let next = at(value + step, &middle.point, value)?;
            let change = middle.value - next.value;
            if change > 0.0 {
                value += step;
                middle = next;
            }
            if change.abs() < OFFSETS.converged && step.abs() <= reach {
                break;
            }
            reach = (0.5 * step.abs()).clamp(OFFSETS.min_step * reach, reach);
        }
        Some((value, middle))
    }

    /// The problem with the offset taken off the readings.
    fn shifted(&self, value: f64) -> Problem {
        let n = self.problem.states();
        let mut out = self.problem.clone();
        for (record, curve) in out.records.iter_mut().zip(&mut out.smoothed) {
            record.measured[self.state]
                .iter_mut()
                .for_each(|x| *x -= value);
            let own = curve.states.iter_mut().skip(self.state).step_by(n);
            own.for_each(|x| *x -= value);
        }
        out
    }

    fn moved(&self, point: &LinearizationPoint, value: f64) -> LinearizationPoint {
        let n = self.problem.states();
        let mut out = point.clone();
        for path in &mut out.paths {
            let own = path.iter_mut().skip(self.state).step_by(n);
            own.for_each(|x| *x -= value);
        }
        out
    }
}

fn dropped(point: &LinearizationPoint, column: usize) -> LinearizationPoint {
    let mut out = point.clone();
    if let Some(at) = out.support.iter().position(|j| *j == column) {
        out.support.remove(at);
        out.coefficients.remove(at);
    }
    out
}
