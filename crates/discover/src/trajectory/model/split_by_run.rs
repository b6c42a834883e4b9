//! A problem whose coefficients have a value of their own in each run: one column a run, which is zero in all others.
//!
//! In: a problem, columns whose coefficients may differ. Out: the same problem with these columns split by run, or on some of its runs
//! alone. Fits nothing.

use std::collections::BTreeMap;

use super::estimation_problem::Problem;
use super::record::Record;
use super::rejected_readings::LeftOut;
use super::run_columns::{RunColumn, RunColumns};
use sidc_lang::term::{Signal, Term, VarId};

/// The signal that is 1 in one run and 0 in all others. No model declares so many variables.
pub(crate) fn indicator(trajectory: usize) -> Signal {
    let last = usize::from(u16::MAX);
    Signal::new(VarId(last.saturating_sub(trajectory) as u16))
}

impl Problem {
    /// The runs that have records, by the number of their trajectory.
    pub fn runs(&self) -> Vec<usize> {
        let mut runs: Vec<usize> = self.records.iter().map(|r| r.trajectory).collect();
        runs.sort_unstable();
        runs.dedup();
        runs
    }

    /// The term of a column, without its run.
    pub fn term(&self, column: usize) -> &Term {
        match self.run_columns.get(column) {
            Some(own) => &own.term,
            None => &self.system.columns[column],
        }
    }

    /// The problem with a column for each run in place of each column of `split`, and for each of its columns where it comes from.
    pub fn with_run_columns(&self, split: &[usize]) -> (Problem, Vec<usize>) {
        let runs = self.runs();
        let mut problem = self.clone();
        let mut origin = Vec::new();
        if split.is_empty() || runs.len() < 2 {
            origin.extend(0..self.system.columns.len());
            return (problem, origin);
        }
        problem.add_indicators(&runs);
        let system = &mut problem.system;
        let before = std::mem::take(&mut system.columns);
        let mut own = BTreeMap::new();
        for law in &mut system.laws {
            let (from, old) = (system.columns.len(), law.columns.clone());
            let (slots, written) = (
                std::mem::take(&mut law.slots),
                std::mem::take(&mut law.written),
            );
            for (place, j) in old.enumerate() {
                let parts = match split.contains(&j) && self.run_columns.get(j).is_none() {
                    true => runs.iter().copied().map(Some).collect(),
                    false => vec![None],
                };
                let group = origin.len();
                for run in parts {
                    let at = origin.len();
                    origin.push(j);
                    law.slots.extend(slots.get(place));
                    law.written.extend(written.get(place));
                    let term = before[j].clone();
                    let Some(trajectory) = run else {
                        let known = self.run_columns.get(j).cloned();
                        own.extend(known.map(|c| (at, c)));
                        system.columns.push(term);
                        continue;
                    };
                    let alone = term.mul(&Term::signal(indicator(trajectory)));
                    system.columns.push(alone);
                    let column = RunColumn {
                        term,
                        trajectory,
                        // Groups of an earlier split are numbered by columns, too, but of another problem.
                        group: before.len() + group,
                    };
                    own.insert(at, column);
                }
            }
            law.columns = from..system.columns.len();
        }
        problem.run_columns = RunColumns::new(own);
        problem.compile_columns();
        (problem, origin)
    }

    /// The problem with the signals that mark these runs.
    pub(crate) fn with_indicators(&self, runs: impl Iterator<Item = usize>) -> Problem {
        let runs: Vec<usize> = runs.collect();
        let mut problem = self.clone();
        problem.add_indicators(&runs);
        if !runs.is_empty() {
            problem.compile_columns();
        }
        problem
    }

    fn add_indicators(&mut self, runs: &[usize]) {
        for run in runs {
            let marks = |record: &Record| f64::from(u8::from(record.trajectory == *run));
            self.add_constant_signal(indicator(*run), &marks);
        }
    }

    /// The records of some runs alone; noise and spread stay those of all.
    pub fn on_runs(&self, runs: &[usize]) -> Problem {
        let kept = |r: &usize| runs.contains(&self.records[*r].trajectory);
        let origin: Vec<usize> = (0..self.records.len()).filter(kept).collect();
        let records = origin.iter().map(|r| self.records[*r].clone());
        let smoothed = origin.iter().map(|r| self.smoothed[*r].clone());
        let left_out = self.left_out.iter().filter_map(|l| {
            let record = origin.iter().position(|r| *r == l.record)?;
            Some(LeftOut { record, ..*l })
        });
        let left_out = left_out.collect();
        let mut problem = self.with_parts(records.collect(), smoothed.collect(), &origin);
        problem.left_out = left_out;
        problem
    }
}
