//! Exogenous signals that do not change along a record, unknown constants among them.
//!
//! In: a problem, values. Out: the problem with these signals, or with these values of them.

use super::estimation_problem::Problem;
use super::record::{Exogenous, Record};
use sidc_lang::model::Between;
use sidc_lang::term::Signal;

impl Problem {
    /// Adds an exogenous signal that has one value along each record, unless it is there.
    pub(super) fn add_constant_signal(&mut self, signal: Signal, value: &dyn Fn(&Record) -> f64) {
        if self.system.exogenous.contains(&signal) {
            return;
        }
        self.system.exogenous.push(signal);
        self.system.noisy_exogenous.push(false);
        for record in &mut self.records {
            let values = vec![value(record); record.len()];
            let between = Between::Hold;
            record.exogenous.push(Exogenous { values, between });
        }
    }

    /// The problem with these values of constants, each in all trajectories or in one; signals that no law mentions are left aside.
    pub(crate) fn with_constant_values(
        &self,
        values: impl Iterator<Item = (Signal, Option<usize>, f64)>,
    ) -> Problem {
        let mut problem = self.clone();
        for (signal, run, value) in values {
            let Some(place) = self.system.exogenous.iter().position(|s| *s == signal) else {
                continue;
            };
            let own = |r: &&mut Record| run.is_none_or(|run| r.trajectory == run);
            for record in problem.records.iter_mut().filter(own) {
                let column = record.exogenous.get_mut(place);
                column.into_iter().for_each(|e| e.values.fill(value));
            }
        }
        problem
    }
}
