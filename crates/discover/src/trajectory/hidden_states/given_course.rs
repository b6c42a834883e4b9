//! The course of hidden states whose laws are given: these laws, integrated along the readings.
//!
//! In: a problem whose constants have values. Out: a course each. Estimates nothing: what it lacks, the fit of the trajectory makes up.

use nalgebra::{DMatrix, DVector};

use super::thresholds::HIDDEN;
use crate::trajectory::model::{HiddenCourse, Problem};
use sidc_lang::term::{Expr, Tape};

/// Courses of the hidden states of these laws, each of which has no columns. They start at rest. `None` where they diverge.
pub(super) fn given_courses(problem: &Problem, laws: &[usize]) -> Option<Vec<HiddenCourse>> {
    if laws.is_empty() {
        return Some(Vec::new());
    }
    let flow = Flow::new(problem, laws)?;
    let mut courses: Vec<HiddenCourse> = (laws.iter())
        .map(|law| HiddenCourse {
            law: *law,
            records: Vec::new(),
        })
        .collect();
    for r in 0..problem.records.len() {
        let rows = flow.along(r)?;
        for (course, (from, order)) in courses.iter_mut().zip(&flow.chains) {
            let chain = (*from..from + order).map(|i| rows.iter().map(|y| y[i]).collect());
            course.records.push(chain.collect());
        }
    }
    Some(courses)
}

/// The hidden laws as one system of first order.
struct Flow<'a> {
    problem: &'a Problem,
    tape: Tape,
    /// Of each law where its chain starts among the hidden states, and its order.
    chains: Vec<(usize, usize)>,
    /// The states of the problem that the hidden ones are.
    places: Vec<usize>,
}

impl<'a> Flow<'a> {
    fn new(problem: &'a Problem, laws: &[usize]) -> Option<Flow<'a>> {
        let system = &problem.system;
        let known: Vec<Expr> = laws.iter().map(|l| system.laws[*l].known.clone()).collect();
        let tape = Tape::new(&known, &system.evaluation_signals()).ok()?;
        let (mut chains, mut places) = (Vec::new(), Vec::new());
        for law in laws.iter().map(|l| &system.laws[*l]) {
            let order = usize::from(law.target.der);
            chains.push((places.len(), order));
            places.extend(law.state + 1 - order..=law.state);
        }
        Some(Flow {
            problem,
            tape,
            chains,
            places,
        })
    }

    /// The hidden states at every sample of a record.
    fn along(&self, record: usize) -> Option<Vec<Vec<f64>>> {
        let time = &self.problem.records[record].time;
        let mut y = self.at_rest(record);
        let mut rows = vec![y.clone()];
        for (k, pair) in time.windows(2).enumerate() {
            let h = pair[1] - pair[0];
            let fastest = self.fastest(record, k, &y);
            let steps = ((h * fastest).ceil() as usize).clamp(1, HIDDEN.steps);
            for step in 0..steps {
                let part = |c: f64| (step as f64 + c) / steps as f64;
                y = self.step((record, k), &y, h / steps as f64, &part);
            }
            if !y.iter().all(|x| x.is_finite()) {
                return None;
            }
            rows.push(y.clone());
        }
        Some(rows)
    }

    /// The classical Runge–Kutta step of order four.
    fn step(&self, at: (usize, usize), y: &[f64], h: f64, part: &dyn Fn(f64) -> f64) -> Vec<f64> {
        let ahead = |by: f64, slope: &[f64]| -> Vec<f64> {
            y.iter().zip(slope).map(|(y, f)| y + by * h * f).collect()
        };
        let a = self.slope(at, part(0.0), y);
        let b = self.slope(at, part(0.5), &ahead(0.5, &a));
        let c = self.slope(at, part(0.5), &ahead(0.5, &b));
        let d = self.slope(at, part(1.0), &ahead(1.0, &c));
        let sum = |i: usize| a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i];
        (0..y.len()).map(|i| y[i] + h / 6.0 * sum(i)).collect()
    }

    /// Rates of the hidden states `part` of the way from sample k of a record to the next.
    fn slope(&self, (record, k): (usize, usize), part: f64, y: &[f64]) -> Vec<f64> {
        let system = &self.problem.system;
        let (n, m) = (system.states.len(), system.laws.len());
        let (read, curve) = (
            &self.problem.records[record],
            &self.problem.smoothed[record],
        );
        let next = (k + 1).min(read.len() - 1);
        let between = |a: f64, b: f64| a + part * (b - a);
        let line = |from: &[f64], to: &[f64]| -> Vec<f64> {
            from.iter().zip(to).map(|(a, b)| between(*a, *b)).collect()
        };
        let mut inputs = line(curve.at(k, n), curve.at(next, n));
        inputs.extend(line(curve.rate_at(k, m), curve.rate_at(next, m)));
        inputs.extend((0..system.exogenous.len()).map(|x| read.exogenous_at(x, k, part)));
        for (place, value) in self.places.iter().zip(y) {
            inputs[*place] = *value;
        }
        let mut highest = vec![0.0; self.chains.len()];
        self.tape.eval(&inputs, 1, &mut highest, &mut Vec::new());
        let mut slope = vec![0.0; y.len()];
        for ((from, order), top) in self.chains.iter().zip(highest) {
            let last = from + order - 1;
            slope[*from..last].copy_from_slice(&y[from + 1..=last]);
            slope[last] = top;
        }
        slope
    }

    /// Derivatives of the rates by the hidden states, by differences.
    fn jacobian(&self, at: (usize, usize), y: &[f64]) -> DMatrix<f64> {
        let here = self.slope(at, 0.0, y);
        let column = |j: usize| {
            let step = 1e-6 * (1.0 + y[j].abs());
            let mut moved = y.to_vec();
            moved[j] += step;
            let there = self.slope(at, 0.0, &moved);
            let change = there.iter().zip(&here).map(|(a, b)| (a - b) / step);
            DVector::from_iterator(y.len(), change)
        };
        DMatrix::from_columns(&(0..y.len()).map(column).collect::<Vec<_>>())
    }

    /// A bound of the rate at which the hidden states change by themselves, 1/s.
    fn fastest(&self, record: usize, k: usize, y: &[f64]) -> f64 {
        let rates = self.jacobian((record, k), y);
        let rows = (0..y.len()).map(|i| rates.row(i).iter().map(|x| x.abs()).sum());
        let fastest = rows.fold(0.0, f64::max);
        if fastest.is_finite() { fastest } else { 0.0 }
    }

    /// The equilibrium of the hidden states under the first readings, by Newton's method from zero and from values on either side of it,
    /// since laws with roots have no derivative at zero. Zero where no start converges.
    ///
    /// Where all rates vanish at zero throughout the record, as for a population that grows in proportion to its size, the states would
    /// stay at zero; they start from one.
    fn at_rest(&self, record: usize) -> Vec<f64> {
        let zero = vec![0.0; self.places.len()];
        let samples = self.problem.records[record].len();
        let still = |k: usize| {
            self.slope((record, k), 0.0, &zero)
                .iter()
                .all(|f| *f == 0.0)
        };
        if (0..samples).all(still) {
            return vec![1.0; self.places.len()];
        }
        let starts = [0.0, 1.0, 0.01, 100.0, -1.0];
        let mut found = starts.iter().filter_map(|y| self.rest_from(record, *y));
        found.next().unwrap_or(vec![0.0; self.places.len()])
    }

    fn rest_from(&self, record: usize, start: f64) -> Option<Vec<f64>> {
        let at = (record, 0);
        let mut y = vec![start; self.places.len()];
        for _ in 0..HIDDEN.newton_steps {
            let slope = DVector::from_vec(self.slope(at, 0.0, &y));
            let step = self.jacobian(at, &y).lu().solve(&slope)?;
            let moved: Vec<f64> = y.iter().zip(step.iter()).map(|(y, s)| y - s).collect();
            if !moved.iter().all(|x| x.is_finite()) {
                return None;
            }
            let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * (1.0 + a.abs());
            let settled = moved.iter().zip(&y).all(near);
            y = moved;
            if settled {
                return Some(y);
            }
        }
        None
    }
}
