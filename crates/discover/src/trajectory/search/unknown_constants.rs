//! Unknown constants of the largest likelihood, the terms kept.
//!
//! In: a problem, a fit, the constants with their ranges. Out: their values and errors, and the fit there. Chooses no terms.
//!
//! About a fit the laws change with a constant k by ψ = Σ a ∂φ/∂k. As one more column of the laws, with the coefficient δ, ψ makes of the
//! likelihood of (a, δ) that of (a, k + δ) to first order: Gauss–Newton in all of them. The variance of δ is that of k, and those of the
//! coefficients beside it hold the error of k.

use crate::trajectory::likelihood::{Fit, PenalizedLikelihood, fit, is_hopeless};
use crate::trajectory::model::{
    ExtendedProblem, ImpulseSource, LinearizationPoint, Problem, impulse_of, impulses_of, indicator,
};
use crate::trajectory::search::{final_criterion, last_criterion};
use crate::trajectory::thresholds::{CONSTANTS, SEARCH};
use sidc_lang::model::Reset;
use sidc_lang::term::{Expr, Signal, Term};
use sidc_progress::Observer;
use sidc_solve::{LinearConstraint, Sense};
use sidc_system::discovery::NORMAL_97_5;

/// A constant with its value and the range that it is sought in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoughtConstant {
    pub signal: Signal,
    /// The trajectory whose value it is; `None` where all share it.
    pub run: Option<usize>,
    pub value: f64,
    pub range: (f64, f64),
}

/// The constants of the largest likelihood.
#[derive(Clone, Debug)]
pub struct FittedConstants {
    pub constants: Vec<SoughtConstant>,
    /// The criterion there.
    pub value: f64,
    /// Of each constant; infinite where no law of the fit holds it.
    pub standard_errors: Vec<f64>,
    /// Columns of the fit with their coefficients.
    pub terms: Vec<(usize, f64)>,
    /// Variances of these coefficients, the errors of the constants among their causes.
    pub variances: Vec<f64>,
}

impl FittedConstants {
    /// Columns of the fit.
    pub fn support(&self) -> Vec<usize> {
        self.terms.iter().map(|(j, _)| *j).collect()
    }

    /// Whether a constant has a value outside its 95 % interval here.
    pub fn excludes(&self, constants: &[SoughtConstant]) -> bool {
        let own = self.constants.iter().zip(&self.standard_errors);
        let mut pairs = own.zip(constants);
        pairs.any(|((own, e), other)| (own.value - other.value).abs() > NORMAL_97_5 * e)
    }
}

/// As [`fit_constants`], from columns and coefficients that nothing was fitted to. `None` also where the criterion is unlikely to come near
/// `beat`.
pub fn fit_constants_from(
    problem: &Problem,
    start: &[(usize, f64)],
    constants: &[SoughtConstant],
    beat: f64,
    observer: &mut dyn Observer,
) -> Option<FittedConstants> {
    let from = fit_from(problem, start, beat, observer)?.point;
    let criterion = last_criterion(problem, 1.0);
    let found = climb(problem, from, constants, (&criterion, beat), observer)?;
    Some(found.widened(1.0))
}

/// The criterion of columns, from coefficients that nothing was fitted to; the constants stay as they are. Where it is unlikely to come near
/// `beat`, of a fit that was given up.
pub fn value_from(
    problem: &Problem,
    start: &[(usize, f64)],
    beat: f64,
    observer: &mut dyn Observer,
) -> Option<f64> {
    fit_from(problem, start, beat, observer).map(|found| found.value)
}

fn fit_from(
    problem: &Problem,
    start: &[(usize, f64)],
    beat: f64,
    observer: &mut dyn Observer,
) -> Option<Fit> {
    let (support, coefficients) = start.iter().copied().unzip();
    let criterion = final_criterion(problem);
    let point = LinearizationPoint {
        support,
        coefficients,
        ..problem.initial_point(&problem.noise)
    };
    fit(problem, point, &criterion, beat, observer)
}

/// One Gauss–Newton step.
struct Step {
    moves: Vec<f64>,
    standard_errors: Vec<f64>,
    variances: Vec<f64>,
}

/// `None` where the laws hold no constant, nothing can be fitted, or the observer ends the work.
pub fn fit_constants(
    problem: &Problem,
    found: &Fit,
    constants: &[SoughtConstant],
    inefficiency: f64,
    observer: &mut dyn Observer,
) -> Option<FittedConstants> {
    let from = found.point.clone();
    fit_constants_at(problem, from, constants, inefficiency, observer)
}

/// The same from a point with these terms.
pub(super) fn fit_constants_at(
    problem: &Problem,
    from: LinearizationPoint,
    constants: &[SoughtConstant],
    inefficiency: f64,
    observer: &mut dyn Observer,
) -> Option<FittedConstants> {
    let criterion = (&last_criterion(problem, inefficiency), f64::INFINITY);
    let found = climb(problem, from, constants, criterion, observer)?;
    Some(found.widened(inefficiency))
}

/// The likeliest constants of laws that are all given, from a start that may be far off. The floor of the noise is lowered level by level: under a
/// high one, wrong constants cost little, so the fit finds its way.
pub fn fit_constants_by_levels(
    problem: &Problem,
    constants: &[SoughtConstant],
    observer: &mut dyn Observer,
) -> Option<FittedConstants> {
    let (mut here, mut point) = (constants.to_vec(), problem.initial_point(&problem.noise));
    for floor in SEARCH.floors {
        let criterion = PenalizedLikelihood::at_floor(problem, floor, 1.0);
        let sigma = criterion.above_floor(&problem.noise);
        point = LinearizationPoint { sigma, ..point };
        let criterion = (&criterion, f64::INFINITY);
        let found = climb(problem, point.clone(), &here, criterion, observer);
        if let Some(found) = found {
            (here, point) = (found.constants, found.fit.point);
        }
    }
    fit_constants_at(problem, point, &here, 1.0, observer)
}

/// Where Gauss–Newton steps end.
struct Climb {
    constants: Vec<SoughtConstant>,
    fit: Fit,
    /// The last step, which was not taken.
    step: Step,
}

impl Climb {
    /// What it found, with variances that many times as large.
    fn widened(self, inefficiency: f64) -> FittedConstants {
        let errors = self.step.standard_errors.iter();
        let variances = self.step.variances.iter();
        FittedConstants {
            value: self.fit.value,
            terms: self.fit.point.active(),
            standard_errors: errors.map(|e| e * inefficiency.sqrt()).collect(),
            variances: variances.map(|v| v * inefficiency).collect(),
            constants: self.constants,
        }
    }
}

/// Gauss–Newton steps to the likeliest constants. Given up where they are unlikely to come near `beat`.
fn climb(
    problem: &Problem,
    from: LinearizationPoint,
    constants: &[SoughtConstant],
    (criterion, beat): (&PenalizedLikelihood, f64),
    observer: &mut dyn Observer,
) -> Option<Climb> {
    let mut here = constants.to_vec();
    let runs = constants.iter().filter_map(|c| c.run);
    let problem = &problem.with_indicators(runs);
    let at = |constants: &[SoughtConstant]| with_constant_values(problem, constants);
    let mut best = fit(&at(&here), from, criterion, beat, observer)?;
    let criterion = (criterion, beat);
    let mut step = step(&at(&here), &best, &here, criterion, observer)?;
    for left in (0..CONSTANTS.steps).rev() {
        let small = |(c, (by, e)): (&SoughtConstant, (&f64, &f64))| {
            let error = if e.is_finite() {
                CONSTANTS.settled * e
            } else {
                f64::INFINITY
            };
            by.abs() <= error.max(f64::EPSILON * c.value.abs())
        };
        let moves = step.moves.iter().zip(&step.standard_errors);
        if here.iter().zip(moves).all(small) {
            break;
        }
        let mut accepted = None;
        for halvings in 0..CONSTANTS.halvings {
            let part = 0.5_f64.powi(halvings);
            let trial: Vec<SoughtConstant> = (here.iter().zip(&step.moves))
                .map(|(c, by)| c.moved(part * by))
                .collect();
            let there = fit(&at(&trial), best.point.clone(), criterion.0, beat, observer);
            if !observer.go_on() {
                return None;
            }
            if let Some(there) = there.filter(|t| t.value < best.value) {
                accepted = Some((trial, there));
                break;
            }
        }
        let Some((trial, there)) = accepted else {
            break;
        };
        if is_hopeless(there.value - beat, left, best.value - there.value) {
            return None;
        }
        (here, best) = (trial, there);
        step = self::step(&at(&here), &best, &here, criterion, observer)?;
    }
    Some(Climb {
        constants: here,
        fit: best,
        step,
    })
}

/// The problem with these values; signals that no law mentions are left aside.
pub fn with_constant_values(problem: &Problem, constants: &[SoughtConstant]) -> Problem {
    let values = constants.iter().map(|c| (c.signal, c.run, c.value));
    problem.with_constant_values(values)
}

impl SoughtConstant {
    /// Moves the value by a step, within its range. If the range has one sign the value changes by at most a factor of e.
    fn moved(self, by: f64) -> SoughtConstant {
        let (from, to) = self.range;
        let e = std::f64::consts::E;
        let free = self.value + by;
        let near = match from * to > 0.0 {
            true => {
                self.value.signum() * free.abs().clamp(self.value.abs() / e, self.value.abs() * e)
            }
            false => free,
        };
        // A step across zero would change the sign; the value then moves as far towards zero as one step may.
        let same = from * to <= 0.0 || free * self.value > 0.0;
        let value = if same { near } else { self.value / e };
        SoughtConstant {
            value: value.clamp(from, to),
            ..self
        }
    }
}

/// A step about a fit at these constants.
fn step(
    problem: &Problem,
    found: &Fit,
    constants: &[SoughtConstant],
    (criterion, beat): (&PenalizedLikelihood, f64),
    observer: &mut dyn Observer,
) -> Option<Step> {
    let (mut extended, new, owners) = with_sensitivities(problem, found, constants)?;
    tie(&mut extended.problem, &new, &owners);
    let kept = extended.point(&found.point);
    let point = with_columns(kept.clone(), &new);
    let fit = fit(&extended.problem, point, criterion, beat, observer)?;
    let place = |column: usize| fit.point.support.iter().position(|j| *j == column);
    let mut out = Step {
        moves: vec![0.0; constants.len()],
        standard_errors: vec![f64::INFINITY; constants.len()],
        variances: kept
            .support
            .iter()
            .filter_map(|j| Some(fit.variances[place(*j)?]))
            .collect(),
    };
    for (column, (k, weight)) in new.iter().zip(&owners) {
        let at = place(*column)?;
        // ψ stands in the laws divided by its weight.
        out.moves[*k] = fit.point.coefficients[at] / weight;
        out.standard_errors[*k] = fit.variances[at].sqrt() / weight.abs();
    }
    Some(out)
}

/// A problem with a column ψ for each constant in each law that holds it; the new columns, and of each its constant and the weight that ψ is
/// divided by.
pub(super) type Sensitivities = (ExtendedProblem, Vec<usize>, Vec<(usize, f64)>);

/// `None` where no law holds a constant.
pub(super) fn with_sensitivities(
    problem: &Problem,
    found: &Fit,
    constants: &[SoughtConstant],
) -> Option<Sensitivities> {
    let laws = &problem.system.laws;
    // For each law the constants that it holds, with the weight of their column.
    let mut held: Vec<Vec<(usize, f64)>> = vec![Vec::new(); laws.len()];
    let mut extra: Vec<Vec<Term>> = vec![Vec::new(); laws.len()];
    let mut impulses = problem.system.impulses.clone();
    for (l, law) in laws.iter().enumerate() {
        for (k, constant) in constants.iter().enumerate() {
            // A range of one value keeps a constant where it is.
            if constant.range.0 == constant.range.1 {
                continue;
            }
            let own = found.point.active().into_iter();
            let own = own.filter(|(j, _)| law.columns.contains(j));
            let moved = own.map(|(j, a)| {
                problem.system.columns[j]
                    .derivative(constant.signal)
                    .scale(a)
            });
            let mut slope: Expr = moved.sum::<Expr>() + law.known.derivative(constant.signal);
            let active = found.point.active().into_iter();
            let jumping = active.filter(|(j, _)| law.columns.contains(j));
            let jumping = jumping.map(|(j, a)| (a, &problem.system.columns[j]));
            for (a, term) in jumping.chain(law.known.terms()) {
                slope = slope + impulses_of(term, constant.signal, &mut impulses).scale(a);
            }
            if slope.as_number() == Some(0.0) {
                continue;
            }
            let (weight, term) = slope.into_term();
            held[l].push((k, weight));
            extra[l].push(of_run(term, constant));
        }
    }
    // What a constant does to jumps is no part of a law; its column stands in the first.
    for (k, constant) in constants.iter().enumerate() {
        let mut resets = problem.system.resets.iter().flat_map(Reset::expressions);
        if constant.range.0 != constant.range.1 && resets.any(|e| e.mentions(constant.signal)) {
            let signal = impulse_of(ImpulseSource::Jump(constant.signal), &mut impulses);
            held[0].push((k, 1.0));
            extra[0].push(of_run(Term::signal(signal), constant));
        }
    }
    let extended = match impulses.is_empty() {
        true => problem.with_extra_columns(&extra),
        false => problem.with_impulses(impulses).with_extra_columns(&extra),
    };
    let new: Vec<usize> = (0..extended.origin.len())
        .filter(|j| extended.origin[*j].is_none())
        .collect();
    let owners: Vec<(usize, f64)> = held.into_iter().flatten().collect();
    if owners.is_empty() || new.len() != owners.len() {
        return None;
    }
    Some((extended, new, owners))
}

/// A term that acts in the run of a constant alone.
fn of_run(term: Term, constant: &SoughtConstant) -> Term {
    match constant.run {
        Some(run) => term.mul(&Term::signal(indicator(run))),
        None => term,
    }
}

/// Ties the slope columns of a constant: it changes by the same amount in all laws that hold it.
pub(super) fn tie(problem: &mut Problem, new: &[usize], owners: &[(usize, f64)]) {
    let columns: Vec<(usize, usize, f64)> = new
        .iter()
        .zip(owners)
        .map(|(j, (k, w))| (*j, *k, *w))
        .collect();
    for (place, (column, constant, weight)) in columns.iter().enumerate() {
        let first = columns[..place].iter().find(|c| c.1 == *constant);
        let Some((other, _, other_weight)) = first else {
            continue;
        };
        let constraints = &mut problem.system.constraints;
        constraints.rows.push(LinearConstraint {
            entries: vec![(0, *column, 1.0 / weight), (0, *other, -1.0 / other_weight)],
            sense: Sense::Equal,
            right: 0.0,
        });
        constraints.stated.push(usize::MAX);
    }
}

/// The point with these columns in its support, coefficients zero.
pub(super) fn with_columns(point: LinearizationPoint, new: &[usize]) -> LinearizationPoint {
    let mut active = point.active();
    active.extend(new.iter().map(|j| (*j, 0.0)));
    active.sort_by_key(|(j, _)| *j);
    let (support, coefficients) = active.into_iter().unzip();
    LinearizationPoint {
        support,
        coefficients,
        ..point
    }
}
