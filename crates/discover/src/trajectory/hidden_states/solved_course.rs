//! The course of hidden states that a sensor follows by a law that is given: that law, solved for them.
//!
//! In: a problem whose constants have values. Out: a course of each hidden state, with the columns it was found with. Example: a sensor
//! with a lag obeys dy = (x − y)/τ, so x = y + τ dy along the smoothed readings y; columns of the laws of x are then selected as if x had
//! been read. It is a guess: the fit of the trajectory takes all laws as they are written.

use super::filtered_course::Start;
use super::observed_fit::{ObservedFit, every_column, observed_fits};
use super::thresholds::HIDDEN;
use crate::trajectory::model::{HiddenCourse, Problem, gradient};
use sidc_lang::term::{Expr, Signal, Tape};
use sidc_progress::Observer;

/// The courses, with the columns of each price and slack of a first linearisation. Empty if some hidden state is in no given law that can
/// be solved for it.
pub(super) fn solved_courses(
    problem: &Problem,
    laws: &[usize],
    observer: &mut dyn Observer,
) -> Vec<Start> {
    let Some((courses, fits)) = solved_fits(problem, laws, observer) else {
        return Vec::new();
    };
    let mut starts: Vec<Start> = Vec::new();
    for fit in fits {
        if !starts.iter().any(|(_, terms)| *terms == fit.terms) {
            starts.push((courses.clone(), fit.terms));
        }
    }
    starts
}

/// How well all laws are obeyed along the solved courses; infinite where there are none.
pub(super) fn value_of_solved(
    problem: &Problem,
    laws: &[usize],
    observer: &mut dyn Observer,
) -> f64 {
    let fits = solved_fits(problem, laws, observer).map(|(_, fits)| fits);
    let best = fits.and_then(|fits| fits.into_iter().next());
    best.map_or(f64::INFINITY, |fit| fit.value)
}

/// The courses, and fits of all laws along them, the best first.
fn solved_fits(
    problem: &Problem,
    laws: &[usize],
    observer: &mut dyn Observer,
) -> Option<(Vec<HiddenCourse>, Vec<ObservedFit>)> {
    let read = laws.iter().map(|l| SolvedLaw::of(problem, *l));
    let read: Vec<SolvedLaw> = read.collect::<Option<_>>()?;
    if problem.system.columns.len() > HIDDEN.columns {
        return None;
    }
    let courses = read.iter().map(SolvedLaw::course);
    let courses: Vec<HiddenCourse> = courses.collect::<Option<_>>()?;
    let mut as_read = problem.with_hidden_courses(&courses, &[]);
    for one in &read {
        one.add_pseudo_readings(&mut as_read);
    }
    as_read.update_noise();
    let mut fits = observed_fits(&as_read, &every_column(&as_read), observer);
    fits.sort_by(|a, b| a.value.total_cmp(&b.value));
    Some((courses, fits))
}

/// Whether the course of every hidden state whose law is sought follows from a given law.
pub(super) fn are_solved(problem: &Problem, laws: &[usize]) -> bool {
    !laws.is_empty() && laws.iter().all(|l| SolvedLaw::of(problem, *l).is_some())
}

/// A given law of a measured state that is linear in a hidden state z: rate = law(0) + slope z.
struct SolvedLaw<'a> {
    problem: &'a Problem,
    /// The law of the hidden state.
    hidden: usize,
    /// The given law, and the signal of its rate.
    given: usize,
    /// The law and its slope in z, compiled.
    parts: Tape,
}

impl<'a> SolvedLaw<'a> {
    fn of(problem: &'a Problem, hidden: usize) -> Option<SolvedLaw<'a>> {
        let system = &problem.system;
        let z = Signal::new(system.laws[hidden].target.var);
        let parts = |known: &Expr| {
            let slope = known.derivative(z);
            let mut others = false;
            let mut see = |s: Signal| others |= s != z && system.hidden.contains(&s.var);
            known.for_each_signal(&mut see);
            let told = slope.as_number() != Some(0.0);
            let straight = slope.terms().all(|(_, t)| !system.mentions_hidden(t));
            (told && straight && !others).then(|| [known.clone(), slope])
        };
        let laws = system.laws.iter().enumerate();
        let given = laws.filter(|(_, l)| l.columns.is_empty() && !system.is_hidden(l.state));
        let mut solvable = given.filter_map(|(l, law)| Some((l, parts(&law.known)?)));
        let (given, parts) = solvable.next()?;
        let parts = Tape::new(&parts, &system.evaluation_signals()).ok()?;
        Some(SolvedLaw {
            problem,
            hidden,
            given,
            parts,
        })
    }

    /// The hidden state at every sample of a record, from the rates of the measured state. `None` where the law cannot be solved for it.
    fn along(&self, record: usize, rate: &[f64]) -> Option<Vec<f64>> {
        let (problem, system) = (self.problem, &self.problem.system);
        let (n, m) = (problem.states(), system.laws.len());
        let (read, curve) = (&problem.records[record], &problem.smoothed[record]);
        let value = |(k, rate): (usize, &f64)| {
            let mut inputs = curve.at(k, n).to_vec();
            inputs[self.state()] = 0.0;
            inputs.extend(curve.rate_at(k, m));
            inputs.extend(read.exogenous.iter().map(|e| e.values[k]));
            let mut parts = [0.0; 2];
            self.parts.eval(&inputs, 1, &mut parts, &mut Vec::new());
            Some((rate - parts[0]) / parts[1]).filter(|z| z.is_finite())
        };
        rate.iter().enumerate().map(value).collect()
    }

    /// The place of the hidden state among all states.
    fn state(&self) -> usize {
        let law = &self.problem.system.laws[self.hidden];
        law.state + 1 - usize::from(law.target.der)
    }

    fn course(&self) -> Option<HiddenCourse> {
        let (problem, m) = (self.problem, self.problem.system.laws.len());
        let order = usize::from(problem.system.laws[self.hidden].target.der);
        let chain = |r: usize| {
            let rate = &problem.smoothed[r].rates;
            let rate: Vec<f64> = rate.iter().skip(self.given).step_by(m).copied().collect();
            let mut chain = vec![self.along(r, &rate)?];
            for d in 1..order {
                chain.push(gradient(&problem.records[r].time, &chain[d - 1]));
            }
            Some(chain)
        };
        Some(HiddenCourse {
            law: self.hidden,
            records: (0..problem.records.len())
                .map(chain)
                .collect::<Option<_>>()?,
        })
    }

    /// Gives the hidden state readings, in a problem that has its course: the given law, solved with differences of the raw readings as
    /// rates. The distance of these from the course counts as their noise.
    fn add_pseudo_readings(&self, as_read: &mut Problem) {
        let system = &self.problem.system;
        let (law, state) = (&system.laws[self.hidden], self.state());
        let measured = system.laws[self.given].state;
        let n = system.states.len();
        as_read.system.hidden.retain(|var| *var != law.target.var);
        for r in 0..self.problem.records.len() {
            let record = &self.problem.records[r];
            let rate = gradient(&record.time, &record.measured[measured]);
            let Some(readings) = self.along(r, &rate) else {
                continue;
            };
            let course = as_read.smoothed[r].states.iter().skip(state).step_by(n);
            let squares = course.zip(&readings).map(|(x, y)| (x - y).powi(2));
            let noise = (squares.sum::<f64>() / readings.len().max(1) as f64).sqrt();
            as_read.smoothed[r].noise[state] = Some(noise);
            as_read.records[r].measured[state] = readings;
        }
    }
}
