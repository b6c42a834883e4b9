//! From a design to an estimate: the solver proposes terms, the criterion selects, least squares gives the coefficients.
//!
//! In: design matrix, target and tolerance. Out: the terms selected with coefficients, standard errors and certificate. Never
//! judges the result.

use crate::regression::certificate::certify;
use crate::regression::design::Design;
use crate::regression::norm_search::Proposal;
use crate::regression::task::Task;
use crate::selection::information_criterion::InformationCriterion;
use crate::selection::term_selection::TermSelection;
use sidc_lang::library::Grading;
use sidc_lang::term::{Atom, Language, Term};
use sidc_progress::{EquationObserver, Stop};
use sidc_solve as solve;
use sidc_solve::{Problem, Refit, Solution, Status as Solved};
use sidc_system::discovery::{NormGrading, Proof, Witness};

/// The proposal of the solver, and the terms that the criterion selected.
pub(crate) struct Selected {
    pub proposal: Proposal,
    pub criterion: InformationCriterion,
    pub selection: TermSelection,
    pub polished: Refit,
    stopped: Option<Stop>,
}

/// The terms that are printed, and how they were found.
pub(crate) struct Estimate {
    /// Columns of Φ, rising; coefficients and standard errors are in this order.
    pub support: Vec<usize>,
    pub coefficients: Vec<f64>,
    pub standard_errors: Vec<f64>,
    pub proof: Proof,
    /// From what the proof can be verified, without its rows.
    pub witness: Witness,
    pub ties: Vec<Vec<usize>>,
    pub searched: usize,
    pub solver: &'static str,
    /// Whether the solver gives a dual point.
    pub exact: bool,
    /// Terms that the solver proposed.
    pub proposed: usize,
    pub iterations: usize,
    pub status: Solved,
    pub stopped: Option<Stop>,
}

impl Selected {
    /// Takes a sparser fit instead of the selection.
    pub fn replace(&mut self, design: &Design, support: Vec<usize>) {
        self.polished = solve::refit(design.phi.as_ref(), &design.target, &support);
        self.selection.as_proposed = false;
        self.selection.searched = design.phi.cols();
        self.selection.ties.clear();
        self.selection.support = support;
    }

    /// (column, coefficient) of the selection.
    pub fn pairs(&self) -> Vec<(usize, f64)> {
        pairs(&self.selection.support, &self.polished.coefficients)
    }
}

impl Estimate {
    /// (column, coefficient) of the terms.
    pub fn pairs(&self) -> Vec<(usize, f64)> {
        pairs(&self.support, &self.coefficients)
    }
}

/// (column, coefficient) pairs.
pub(crate) fn pairs(columns: &[usize], coefficients: &[f64]) -> Vec<(usize, f64)> {
    let columns = columns.iter().copied();
    columns.zip(coefficients.iter().copied()).collect()
}

impl Task<'_> {
    /// Runs the solver under each grading, selects terms by the criterion and fits them.
    pub fn select(
        &self,
        design: &mut Design,
        gradings: &[Grading],
        watcher: &mut EquationObserver,
    ) -> Selected {
        let mut proposals = self.norm_search(design).proposals(gradings, watcher);
        let sparsest = proposals.first().map(|p| &p.solution);
        let largest = sparsest.map_or(0.0, |s| largest_contribution(&design.problem(), s));
        design.weights.raise_floor(largest);
        let (phi, weights) = (design.phi.as_ref(), &design.weights);
        let criterion = InformationCriterion::new(
            phi.rows(),
            weights.correlation,
            self.library.len(),
            weights.floor,
        );
        let selection = self.best_selection(design, &mut proposals, criterion, watcher);
        let proposal = proposals.swap_remove(0);
        let cut = selection.cut || proposal.solution.status == Solved::Interrupted;
        Selected {
            polished: solve::refit(phi, &design.target, &selection.support),
            stopped: watcher.stop().filter(|_| cut),
            proposal,
            criterion,
            selection,
        }
    }

    /// The selection as an estimate, with its certificate.
    pub fn estimate(&self, design: &Design, selected: &Selected) -> Estimate {
        let Selected {
            proposal,
            selection,
            polished,
            ..
        } = selected;
        let solution = &proposal.solution;
        let (mut proof, mut witness) = proposal.with_problem(&design.problem(), |p| {
            certify(p, solution, selection, polished)
        });
        proof.grading = self.norm_grading(&proposal.grading);
        witness.grading = proposal.grading.clone();
        Estimate {
            support: selection.support.clone(),
            coefficients: polished.coefficients.clone(),
            standard_errors: polished.standard_errors.clone(),
            proof,
            witness,
            ties: selection.ties.clone(),
            searched: selection.searched,
            solver: self.options.solver.name(),
            exact: self.options.solver.exact(),
            proposed: proposal.terms,
            iterations: solution.iterations,
            status: solution.status.clone(),
            stopped: selected.stopped,
        }
    }

    /// A grading as it is told; `None` for the plain norm.
    fn norm_grading(&self, grading: &Grading) -> Option<NormGrading> {
        let name = |atom: &Atom| Language(self.model).term(&Term::atom(atom.clone()));
        (!grading.is_plain()).then(|| NormGrading {
            base: grading.base,
            penalized: grading.penalized.as_ref().map(name).unwrap_or_default(),
        })
    }
}

/// Root mean square of the largest coefficient times its column.
fn largest_contribution(problem: &Problem, solution: &Solution) -> f64 {
    let largest = problem
        .contributions(&solution.coefficients)
        .fold(0.0, f64::max);
    largest / (problem.target.len() as f64).sqrt()
}
