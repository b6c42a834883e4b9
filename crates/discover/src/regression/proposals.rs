//! From the answers of a solver in several norms to the terms that are kept.
//!
//! In: a design. Out: which norms to look in, and the selection of best criterion among what they propose. Judges nothing.

use crate::regression::design::{Design, RowKind};
use crate::regression::norm_search::{NormSearch, Proposal};
use crate::regression::task::Task;
use crate::regression::thresholds::GRADING;
use crate::selection::information_criterion::InformationCriterion;
use crate::selection::term_selection::{TermSelection, select_terms};
use crate::selection::thresholds::TERM_SELECTION;
use sidc_lang::library::Grading;
use sidc_lang::model::PreferredNorms;
use sidc_progress::{EquationObserver, Stage};

impl Task<'_> {
    /// The search for this equation.
    pub fn norm_search<'a>(&'a self, design: &'a Design) -> NormSearch<'a> {
        let samples = match &design.basis {
            RowKind::Samples { used, .. } => used,
            RowKind::Integrals { .. } => self.samples,
        };
        NormSearch {
            library: self.library,
            samples,
            problem: design.problem(),
            solver: self.options.solver,
        }
    }

    /// The norms in which the solver proposes terms for this equation, plain first. The plain norm is enough if all candidates
    /// are searched and rows outnumber them, so that proposals matter little, and for solvers that never give up a path.
    pub fn gradings(&self, design: &Design) -> Vec<Grading> {
        let (rows, columns) = (design.phi.rows(), design.phi.cols());
        let searched = columns <= TERM_SELECTION.exhaustive_columns && columns < rows;
        let one = searched || !self.options.solver.gives_up();
        match (self.model.norms, one) {
            (PreferredNorms::Degree, _) => self.norm_search(design).graded(),
            (PreferredNorms::Plain, _) | (_, true) => vec![Grading::PLAIN],
            (PreferredNorms::Any, false) => self.norm_search(design).every_norm(),
        }
    }

    /// The proposal from which the best set of terms was selected, moved to the front, and that selection.
    pub fn best_selection(
        &self,
        design: &Design,
        proposals: &mut [Proposal],
        criterion: InformationCriterion,
        watcher: &mut EquationObserver,
    ) -> TermSelection {
        let fewest = proposals.first().map_or(0, |p| p.terms);
        let near = |p: &Proposal| p.answers() && p.terms <= GRADING.near * fewest;
        let mut selections: Vec<(usize, TermSelection)> = Vec::new();
        for (place, proposal) in proposals.iter().enumerate() {
            if place > 0 && !near(proposal) {
                continue;
            }
            let selection = select_terms(
                design.phi.as_ref(),
                &design.target,
                &proposal.solution.coefficients,
                (criterion, self.library.required()),
                watcher.during(Stage::Choosing),
            );
            let known = selections
                .iter()
                .any(|(_, s)| s.support == selection.support);
            if !known || selection.as_proposed {
                selections.push((place, selection));
            }
        }
        let order = |s: &TermSelection| (s.value, !s.as_proposed);
        let best = selections.into_iter().reduce(|best, next| {
            let (own, other) = (order(&best.1), order(&next.1));
            let same = best.1.support == next.1.support;
            let better = match same {
                true => !other.1 && own.1,
                false => other.0 < own.0,
            };
            if better { next } else { best }
        });
        let Some((place, selection)) = best else {
            return TermSelection::default();
        };
        proposals[..=place].rotate_right(1);
        selection
    }
}
