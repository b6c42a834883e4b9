//! The course of hidden states whose laws are sought: filters of what may drive them.
//!
//! In: a problem. Out: a course of each, with the columns that it was found with. A law that is linear in its hidden state z, with a
//! constant time τ, makes z a sum of its other terms, each through a filter of that time (a state variable filter: Young, 1981). For a given
//! τ the measured laws are then linear in what is unknown, and columns are selected as in any library. It is a guess: the fit of the
//! trajectory takes the law as it is written.

use super::observed_fit::{ObservedFit, observed_fits};
use super::thresholds::HIDDEN;
use crate::trajectory::model::{HiddenCourse, ObservedPart, Problem, Record};
use sidc_lang::term::{Atom, Expr, Signal, Tape, Term, VarId};
use sidc_progress::Observer;

/// Courses of the hidden states, and columns of the whole problem with coefficients.
pub(super) type Start = (Vec<HiddenCourse>, Vec<(usize, f64)>);

/// Courses of the hidden states by filters with the time constants at which the measured laws follow the readings best, the likeliest
/// first. For every slack and price of a first linearisation these are the local minima over the time constants tried. Empty where no
/// filter helps, or the observer ends the work.
pub(super) fn filtered_courses(
    problem: &Problem,
    laws: &[usize],
    observer: &mut dyn Observer,
) -> Vec<Start> {
    let Some(filters) = Filters::new(problem, laws) else {
        return Vec::new();
    };
    let times = filters.times();
    let mut fits: Vec<Vec<ObservedFit>> = Vec::new();
    for time in &times {
        if !observer.go_on() {
            return Vec::new();
        }
        fits.push(filters.fits(*time, observer));
    }
    let mut minima: Vec<(f64, f64, &ObservedFit)> = Vec::new();
    for (k, (time, here)) in times.iter().zip(&fits).enumerate() {
        let near = |other: Option<usize>, kind: usize| {
            let fit = fits.get(other?)?.get(kind)?;
            Some(fit.value)
        };
        for (kind, fit) in here.iter().enumerate() {
            let beside = [near(k.checked_sub(1), kind), near(Some(k + 1), kind)];
            let least = beside.iter().flatten().all(|value| fit.value <= *value);
            if least {
                minima.push((fit.value, *time, fit));
            }
        }
    }
    minima.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all = minima
        .iter()
        .filter_map(|(_, time, fit)| filters.courses(*time, fit));
    let mut distinct: Vec<Start> = Vec::new();
    for one in all {
        let same = |o: &Start| o.1 == one.1;
        if !distinct.iter().any(same) {
            distinct.push(one);
        }
    }
    distinct.truncate(HIDDEN.courses);
    distinct
}

/// The origin of a column of the measured part that replaces a hidden state in a term by one of its filtered drives.
#[derive(Clone, Copy)]
struct Filtered {
    /// The column of the whole problem that has the hidden state.
    column: usize,
    /// Which hidden law, and which of its drives; `None` for the decay of its start.
    hidden: usize,
    drive: Option<usize>,
}

struct Filters<'a> {
    problem: &'a Problem,
    part: ObservedPart,
    /// Of every column of the part; `None` for those without a hidden state.
    made: Vec<Option<Filtered>>,
    laws: Vec<HiddenLaw>,
}

struct HiddenLaw {
    law: usize,
    signal: Signal,
    /// Columns without hidden states.
    drives: Vec<usize>,
    /// Their values along the smoothed trajectories, record by record.
    values: Vec<Vec<Vec<f64>>>,
    /// Whether each of them is held between samples.
    held: Vec<bool>,
}

/// The signal of a filtered drive of a hidden law; models have no variable of that number.
fn filtered_signal(hidden: usize, drive: Option<usize>, drives: usize) -> Signal {
    let place = hidden * (drives + 1) + drive.map_or(0, |d| d + 1);
    let first = usize::from(u16::MAX) / 2 + 1;
    Signal::new(VarId((first + place).min(usize::from(u16::MAX)) as u16))
}

impl<'a> Filters<'a> {
    fn new(problem: &'a Problem, laws: &[usize]) -> Option<Filters<'a>> {
        let laws: Vec<HiddenLaw> = (laws.iter())
            .map(|law| HiddenLaw::new(problem, *law))
            .collect::<Option<_>>()?;
        let most = laws.iter().map(|l| l.drives.len()).max()?;
        let mut made = Vec::new();
        let columns = |law: usize| -> Vec<(Option<usize>, Term, Option<Filtered>)> {
            let own = problem.system.laws[law].columns.clone();
            own.flat_map(|j| filtered_columns(problem, &laws, most, j))
                .collect()
        };
        let mut room = HIDDEN.columns;
        let mut all: Vec<Vec<(Option<usize>, Term)>> = Vec::new();
        for (l, law) in problem.system.laws.iter().enumerate() {
            let own = match problem.system.is_hidden(law.state) {
                true => Vec::new(),
                false => columns(l),
            };
            let kept: Vec<_> = own.into_iter().take(room).collect();
            room -= kept.len();
            made.extend(kept.iter().map(|(_, _, filtered)| *filtered));
            all.push(kept.into_iter().map(|(place, t, _)| (place, t)).collect());
        }
        let part = problem.observed_part(&|l| all[l].clone());
        Some(Filters {
            problem,
            part,
            made,
            laws,
        })
    }

    /// The time constants that are tried, s: from the step between samples to beyond the records.
    fn times(&self) -> Vec<f64> {
        let (step, _) = self.problem.step_and_length();
        let length = |r: &Record| {
            r.time
                .last()
                .zip(r.time.first())
                .map_or(0.0, |(b, a)| b - a)
        };
        let longest = self.problem.records.iter().map(length).fold(0.0, f64::max);
        // A record of one row has no step. Instants so extreme that step or length is not a normal number would make the list endless.
        let first = (step.is_normal() && longest.is_normal()).then_some(step);
        let times = std::iter::successors(first, |t| Some(t * HIDDEN.time_ratio));
        times
            .take_while(|t| *t <= HIDDEN.longest * longest)
            .take(HIDDEN.times)
            .collect()
    }

    /// The filtered drives of a law in a record, the decay of its start first: derivatives below the highest of each.
    fn filtered(&self, law: &HiddenLaw, record: usize, time: f64) -> Vec<Vec<Vec<f64>>> {
        let read = &self.problem.records[record];
        let order = usize::from(self.problem.system.laws[law.law].target.der);
        let decay: Vec<f64> = (read.time.iter())
            .map(|t| ((read.time[0] - t) / time).exp())
            .collect();
        let decay = match order {
            1 => vec![decay],
            _ => {
                let rate = decay.iter().map(|x| -x / time).collect();
                vec![decay, rate]
            }
        };
        let drives = law.values[record].iter().zip(&law.held);
        let through = drives.map(|(values, held)| {
            let first = lag(&read.time, values, *held, time);
            match order {
                1 => vec![first],
                _ => {
                    let second = lag(&read.time, &first, false, time);
                    let pairs = first.iter().zip(&second);
                    let rate = pairs.map(|(a, b)| (a - b) / time).collect();
                    vec![second, rate]
                }
            }
        });
        std::iter::once(decay).chain(through).collect()
    }

    fn fits(&self, time: f64, observer: &mut dyn Observer) -> Vec<ObservedFit> {
        let mut problem = self.part.problem.clone();
        let most = self.laws.iter().map(|l| l.drives.len()).max().unwrap_or(0);
        for (h, law) in self.laws.iter().enumerate() {
            let records = 0..self.problem.records.len();
            let filtered: Vec<_> = records.map(|r| self.filtered(law, r, time)).collect();
            for place in 0..=law.drives.len() {
                let signal = filtered_signal(h, place.checked_sub(1), most);
                let values = filtered.iter().map(|f| &f[place][0][..]);
                problem.set_exogenous(signal, values);
            }
        }
        observed_fits(&problem, &self.sets(), observer)
    }

    /// Sets of columns of the part: all, and for one hidden state those in which it stands in one term alone. Among all, columns of other
    /// terms make up for a time constant that is not quite right.
    fn sets(&self) -> Vec<Vec<usize>> {
        let all = 0..self.made.len();
        let mut sets = vec![all.clone().collect()];
        let mut terms: Vec<usize> = self.made.iter().flatten().map(|f| f.column).collect();
        terms.dedup();
        if self.laws.len() > 1 || terms.len() < 2 {
            return sets;
        }
        sets.extend(terms.iter().map(|term| {
            let own = |j: &usize| self.made[*j].is_none_or(|f| f.column == *term);
            all.clone().filter(own).collect()
        }));
        sets
    }

    /// The hidden courses, and columns of the whole problem with coefficients, that a fit with filters of this time constant stands for.
    fn courses(&self, time: f64, fit: &ObservedFit) -> Option<Start> {
        let mut terms: Vec<(usize, f64)> = Vec::new();
        for (j, a) in &fit.terms {
            let column = self.part.origin[*j].filter(|_| self.made[*j].is_none());
            terms.extend(column.map(|c| (c, *a)));
        }
        let mut courses = Vec::new();
        for (h, law) in self.laws.iter().enumerate() {
            let own: Vec<(Filtered, f64, f64)> = (fit.terms.iter().zip(&fit.strengths))
                .filter_map(|((j, a), s)| Some((self.made[*j].filter(|f| f.hidden == h)?, *a, *s)))
                .collect();
            let records = 0..self.problem.records.len();
            let filtered: Vec<_> = records.map(|r| self.filtered(law, r, time)).collect();
            let leading = own.iter().filter(|(f, ..)| f.drive.is_some());
            let leading = leading.max_by(|a, b| a.2.total_cmp(&b.2))?.0.column;
            let course = |column: usize| combined(&filtered, &own, column);
            let whole = course(leading);
            let mut columns: Vec<usize> = own.iter().map(|(f, ..)| f.column).collect();
            columns.dedup();
            for column in columns {
                let part = match column == leading {
                    true => 1.0,
                    false => regression(&course(column), &whole),
                };
                terms.push((column, part));
            }
            terms.extend(self.law_terms(law, time, &own, leading));
            courses.push(HiddenCourse {
                law: law.law,
                records: whole,
            });
        }
        terms.sort_by_key(|(j, _)| *j);
        terms.dedup_by_key(|(j, _)| *j);
        Some((courses, terms))
    }

    /// The terms of the hidden law that filters of this time constant stand for: its decay and its drives, with their coefficients.
    fn law_terms(
        &self,
        law: &HiddenLaw,
        time: f64,
        own: &[(Filtered, f64, f64)],
        leading: usize,
    ) -> Vec<(usize, f64)> {
        let system = &self.problem.system;
        let place = |s: Signal| {
            let mut columns = system.laws[law.law].columns.clone();
            columns.find(|j| system.columns[*j] == Term::signal(s))
        };
        let order = i32::from(system.laws[law.law].target.der);
        let mut terms: Vec<(usize, f64)> = Vec::new();
        terms.extend(place(law.signal).map(|j| (j, -time.powi(-order))));
        if order == 2 {
            let rate = Signal::derivative(law.signal.var, 1);
            terms.extend(place(rate).map(|j| (j, -2.0 / time)));
        }
        let driven = own.iter().filter(|(f, ..)| f.column == leading);
        terms.extend(
            driven.filter_map(|(f, a, _)| Some((law.drives[f.drive?], a * time.powi(-order)))),
        );
        terms
    }
}

impl HiddenLaw {
    fn new(problem: &Problem, law: usize) -> Option<HiddenLaw> {
        let system = &problem.system;
        let own = &system.laws[law];
        let mut drives: Vec<usize> = (own.columns.clone())
            .filter(|j| !system.mentions_hidden(&system.columns[*j]))
            .collect();
        if own.target.der == 1 {
            // A rate through a filter is (x − x through the filter)/τ, so it is no further column.
            let terms: Vec<Term> = drives.iter().map(|j| system.columns[*j].clone()).collect();
            drives.retain(|j| !is_rate_of_another(&system.columns[*j], &terms));
        }
        let exprs: Vec<Expr> = (drives.iter())
            .map(|j| system.columns[*j].clone().into())
            .collect();
        let tape = Tape::new(&exprs, &system.evaluation_signals()).ok()?;
        let values = (0..problem.records.len()).map(|r| along(problem, r, &tape));
        let held = |j: &usize| {
            let mut held = true;
            system.columns[*j].for_each_signal(&mut |s| {
                let place = system.exogenous.iter().position(|e| *e == s);
                let records = problem.records.first();
                held &= place.is_some_and(|i| records.is_some_and(|r| r.exogenous[i].is_held()));
            });
            held
        };
        Some(HiddenLaw {
            law,
            signal: Signal::new(own.target.var),
            values: values.collect(),
            held: drives.iter().map(held).collect(),
            drives,
        })
    }
}

/// Whether a term is the derivative of a signal that is a term, too.
fn is_rate_of_another(term: &Term, terms: &[Term]) -> bool {
    let mut rate = false;
    term.for_each_signal(&mut |s| {
        let lower = s
            .der
            .checked_sub(1)
            .map(|der| Signal::derivative(s.var, der));
        rate |= *term == Term::signal(s) && lower.is_some_and(|l| terms.contains(&Term::signal(l)));
    });
    rate
}

/// The values of expressions along a smoothed record, each of its length; infinite ones are taken as zero.
fn along(problem: &Problem, record: usize, tape: &Tape) -> Vec<Vec<f64>> {
    let (n, m) = (problem.states(), problem.system.laws.len());
    let (read, curve) = (&problem.records[record], &problem.smoothed[record]);
    let samples = read.len();
    let mut inputs = Vec::new();
    for i in 0..n {
        inputs.extend(curve.states.iter().skip(i).step_by(n));
    }
    for l in 0..m {
        inputs.extend(curve.rates.iter().skip(l).step_by(m));
    }
    for exogenous in &read.exogenous {
        inputs.extend(&exogenous.values);
    }
    let mut out = vec![0.0; tape.outputs() * samples];
    tape.eval(&inputs, samples, &mut out, &mut Vec::new());
    for x in out.iter_mut().filter(|x| !x.is_finite()) {
        *x = 0.0;
    }
    out.chunks_exact(samples.max(1))
        .map(<[f64]>::to_vec)
        .collect()
}

/// A column of a measured law as the part has it: as it is, or once for each drive of the hidden state that it is linear in.
fn filtered_columns(
    problem: &Problem,
    laws: &[HiddenLaw],
    drives: usize,
    column: usize,
) -> Vec<(Option<usize>, Term, Option<Filtered>)> {
    let system = &problem.system;
    let term = &system.columns[column];
    let sought = |s: Signal| laws.iter().position(|l| l.signal.var == s.var);
    let mut hidden = false;
    term.for_each_signal(&mut |s| hidden |= sought(s).is_some());
    if !hidden {
        return vec![(Some(column), term.clone(), None)];
    }
    for (h, law) in laws.iter().enumerate() {
        let own = |a: &Atom| *a == Atom::Signal(law.signal);
        let linear = term.factors().any(|(a, p)| own(a) && p == 1.0);
        let rest = term.part(|a| !own(a));
        let mut alone = true;
        rest.for_each_signal(&mut |s| alone &= sought(s).is_none());
        if !linear || !alone {
            continue;
        }
        let places = (0..=law.drives.len()).map(|place| place.checked_sub(1));
        let made = places.map(|drive| {
            let signal = filtered_signal(h, drive, drives);
            let filtered = Filtered {
                column,
                hidden: h,
                drive,
            };
            (None, rest.mul(&Term::signal(signal)), Some(filtered))
        });
        return made.collect();
    }
    Vec::new()
}

/// A signal through a first-order filter of gain one, from rest at its first value; between samples it is held, or runs straight.
fn lag(time: &[f64], values: &[f64], held: bool, constant: f64) -> Vec<f64> {
    let Some(mut x) = values.first().copied() else {
        return Vec::new();
    };
    let mut out = vec![x];
    for (t, v) in time.windows(2).zip(values.windows(2)) {
        let h = t[1] - t[0];
        let kept = (-h / constant).exp();
        let (from, slope) = match held {
            true => (v[0], 0.0),
            false => (v[0], v[1] - v[0]),
        };
        x = kept * x + (1.0 - kept) * from + slope * (1.0 - constant / h * (1.0 - kept));
        out.push(x);
    }
    out
}

/// What the filtered drives of one column add up to, in every record.
fn combined(
    filtered: &[Vec<Vec<Vec<f64>>>],
    own: &[(Filtered, f64, f64)],
    column: usize,
) -> Vec<Vec<Vec<f64>>> {
    let of = |record: &Vec<Vec<Vec<f64>>>| -> Vec<Vec<f64>> {
        let mut sum: Vec<Vec<f64>> = record[0].iter().map(|x| vec![0.0; x.len()]).collect();
        for (f, a, _) in own.iter().filter(|(f, ..)| f.column == column) {
            let place = f.drive.map_or(0, |d| d + 1);
            for (sum, values) in sum.iter_mut().zip(&record[place]) {
                sum.iter_mut().zip(values).for_each(|(s, x)| *s += a * x);
            }
        }
        sum
    };
    filtered.iter().map(of).collect()
}

/// The multiple of one course that is nearest to another.
fn regression(of: &[Vec<Vec<f64>>], on: &[Vec<Vec<f64>>]) -> f64 {
    let pairs = || {
        let records = of.iter().zip(on);
        records.flat_map(|(a, b)| a[0].iter().zip(&b[0]))
    };
    let square: f64 = pairs().map(|(_, y)| y * y).sum();
    let product: f64 = pairs().map(|(x, y)| x * y).sum();
    if square > 0.0 { product / square } else { 0.0 }
}
