//! States that nothing measures: where their trajectory starts, and what holds their scale.
//!
//! In: a problem, guessed courses of its hidden states. Out: the problem that starts from them. Guesses nothing.
//!
//! Laws that are sought for a hidden state hold for any multiple of it. One of its samples is therefore held where it is while terms are
//! sought; which multiple is told is decided afterwards.

use super::estimation_problem::{Problem, spread};
use super::held_sample::HeldSample;
use super::smoothing::{SmoothedTrajectory, gradient};

/// The course of a hidden variable.
#[derive(Clone, Debug, Default)]
pub(crate) struct HiddenCourse {
    /// Its law.
    pub law: usize,
    /// Of each record its derivatives below the highest, each of the record's length.
    pub records: Vec<Vec<Vec<f64>>>,
}

impl HiddenCourse {
    /// The course of a law's variable along paths of all states, one for each record, samples × n; `shift` of a sample's states is added.
    pub fn along(
        problem: &Problem,
        law: usize,
        paths: &[Vec<f64>],
        shift: &dyn Fn(&[f64]) -> f64,
    ) -> HiddenCourse {
        let own = &problem.system.laws[law];
        let first = own.state + 1 - usize::from(own.target.der);
        let chain = |path: &Vec<f64>| {
            let rows = || path.chunks_exact(problem.states());
            let along = |i: usize| rows().map(|row| row[i] + shift(row)).collect();
            (first..=own.state).map(along).collect()
        };
        HiddenCourse {
            law,
            records: paths.iter().map(chain).collect(),
        }
    }
}

impl Problem {
    /// The problem whose hidden states start from these courses; those of `free_scale` laws are held at one sample.
    pub(crate) fn with_hidden_courses(
        &self,
        courses: &[HiddenCourse],
        free_scale: &[usize],
    ) -> Problem {
        let mut problem = self.clone();
        let (n, m) = (self.states(), self.system.laws.len());
        for course in courses {
            let law = &self.system.laws[course.law];
            let order = usize::from(law.target.der);
            let first = law.state + 1 - order;
            let records = self.records.iter().zip(&mut problem.smoothed);
            for ((record, curve), chain) in records.zip(&course.records) {
                for (d, values) in chain.iter().enumerate().take(order) {
                    let column = curve.states.iter_mut().skip(first + d).step_by(n);
                    column.zip(values).for_each(|(x, value)| *x = *value);
                }
                let Some(highest) = chain.last() else {
                    continue;
                };
                let rate = gradient(&record.time, highest);
                let column = curve.rates.iter_mut().skip(course.law).step_by(m);
                column.zip(rate).for_each(|(x, value)| *x = value);
            }
            for i in first..first + order {
                problem.spread[i] = spread(&problem.smoothed, i, n);
            }
        }
        problem.update_noise();
        problem.pin(free_scale.iter().map(|l| self.system.laws[*l].state));
        problem
    }

    /// Columns with coefficients that a search may start from.
    pub fn proposed_columns(&self) -> Option<Vec<(usize, f64)>> {
        self.proposed.clone()
    }

    /// Holds these states where they are largest.
    pub(super) fn pin(&mut self, states: impl Iterator<Item = usize>) {
        let n = self.states();
        let largest = |state: usize| {
            let all = self.smoothed.iter().enumerate().flat_map(|(r, curve)| {
                let own = curve.states.iter().skip(state).step_by(n).enumerate();
                own.map(move |(k, x)| (x.abs(), r, k))
            });
            let largest = all.max_by(|a, b| a.0.total_cmp(&b.0));
            largest.map(|(_, record, sample)| HeldSample {
                record,
                sample,
                state,
            })
        };
        self.pins = states.filter_map(largest).collect();
    }

    /// Whether a state is held at a sample.
    pub(crate) fn is_pinned(&self, (record, sample): (usize, usize), state: usize) -> bool {
        let pin = HeldSample {
            record,
            sample,
            state,
        };
        self.pins.contains(&pin)
    }

    /// Takes the hidden states of curves of the same samples.
    pub(super) fn keep_hidden(&mut self, before: &[SmoothedTrajectory]) {
        let (n, m) = (self.states(), self.system.laws.len());
        for (curve, old) in self.smoothed.iter_mut().zip(before) {
            if curve.states.len() != old.states.len() {
                continue;
            }
            for i in (0..n).filter(|i| self.system.is_hidden(*i)) {
                let own = curve.states.iter_mut().skip(i).step_by(n);
                own.zip(old.states.iter().skip(i).step_by(n))
                    .for_each(|(x, y)| *x = *y);
            }
            let laws = self.system.laws.iter().enumerate();
            for (l, _) in laws.filter(|(_, law)| self.system.is_hidden(law.state)) {
                let own = curve.rates.iter_mut().skip(l).step_by(m);
                own.zip(old.rates.iter().skip(l).step_by(m))
                    .for_each(|(x, y)| *x = *y);
            }
        }
    }
}
