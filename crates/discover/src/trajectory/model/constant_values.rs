//! Unknown constants as exogenous signals that do not change.
//!
//! In: a problem, values. Out: the problem with these values.

use super::estimation_problem::Problem;
use super::record::Record;
use sidc_lang::term::Signal;

impl Problem {
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
