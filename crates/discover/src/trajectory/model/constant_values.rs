//! Unknown constants as exogenous signals that do not change.
//!
//! In: a problem, values. Out: the problem with these values.

use super::estimation_problem::Problem;
use sidc_lang::term::Signal;

impl Problem {
    /// The problem with these values of constants; signals that no law mentions are left aside.
    pub fn with_constant_values(&self, values: &[(Signal, f64)]) -> Problem {
        let mut problem = self.clone();
        for (signal, value) in values {
            let Some(place) = self.system.exogenous.iter().position(|s| s == signal) else {
                continue;
            };
            for record in &mut problem.records {
                let column = record.exogenous.get_mut(place);
                column.into_iter().for_each(|e| e.values.fill(*value));
            }
        }
        problem
    }
}
