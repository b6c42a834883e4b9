//! One equation by sparse regression: design matrix, proposal of a solver, selection of terms, certificate, evidence.
//!
//! In: the target, the library and the samples of one equation. Out: the equation with its evidence and doubts, or why it
//! failed. Never looks at other equations, except where the weak form hands on their trajectories.

pub(crate) mod certificate;
pub(crate) mod design;
pub(crate) mod estimate;
mod evidence;
mod given_equation;
mod lasso_path;
mod memory_limit;
pub(crate) mod norm_search;
mod proposals;
pub(crate) mod row_sampling;
mod sparsest;
pub(crate) mod task;
pub(crate) mod thresholds;
pub(crate) mod uncoupled;
pub(crate) mod weak_regression;

use crate::dictionary::BadValue;
use design::Design;
use sidc_progress::EquationObserver;
use sidc_solve::Problem;
use sidc_system::discovery::{Discovery, Equation, Failed};
use task::Task;

impl Task<'_> {
    /// Finds the equation.
    ///
    /// # Errors
    /// A term that the data cannot evaluate; inside, an equation that was not found.
    pub fn run(
        &self,
        names: &Discovery,
        watcher: &mut EquationObserver,
    ) -> Result<Result<Equation, Failed>, Box<BadValue>> {
        let found = self.design(names, watcher)?;
        Ok(found.map(|mut design| self.solve(names, &mut design, watcher)))
    }

    /// The equation from its design.
    fn solve(
        &self,
        names: &Discovery,
        design: &mut Design,
        watcher: &mut EquationObserver,
    ) -> Equation {
        let gradings = self.gradings(design);
        let mut selected = self.select(design, &gradings, watcher);
        let wanted = self.options.sparsest && watcher.stop().is_none();
        let sparsest = wanted.then(|| self.sparsest(names, design, &mut selected, watcher));
        let estimate = self.estimate(design, &selected);
        let mut equation = self.conclude(names, design, &estimate);
        if let Some(evidence) = &mut equation.evidence {
            evidence.sparsest = sparsest.map(Box::new);
        }
        // The path that leads to this answer is that of its norm.
        let path = |p: &Problem| self.lasso_path(p, watcher);
        equation.path = selected.proposal.with_problem(&design.problem(), path);
        equation
    }
}
