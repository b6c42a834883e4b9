//! What a solver proposes under several gradings of the 1-norm.
//!
//! In: a design, gradings. Out: a proposal for each, and the selection of best criterion among what they propose. Judges nothing.

use crate::dictionary::{grades, variations};
use crate::regression::design::{Design, RowKind};
use crate::regression::task::Task;
use crate::regression::thresholds::GRADING;
use crate::selection::information_criterion::InformationCriterion;
use crate::selection::term_selection::{TermSelection, select_terms};
use crate::selection::thresholds::TERM_SELECTION;
use sidc_lang::library::Grading;
use sidc_lang::model::PreferredNorms;
use sidc_progress::{EquationObserver, Stage};
use sidc_solve as solve;
use sidc_solve::dictionary::{Graded, Grades};
use sidc_solve::{Problem, Solution};
use std::sync::Arc;

/// The answer of the solver under one grading.
pub(crate) struct Proposal {
    pub grading: Grading,
    /// `None` in the plain norm.
    pub grades: Option<Grades>,
    pub solution: Solution,
    /// Terms that are more than rounding.
    pub terms: usize,
}

impl Proposal {
    /// Calls `work` with the problem that this proposal answers.
    pub fn problem<A>(&self, design: &Design, work: impl FnOnce(&Problem) -> A) -> A {
        with_grades(design, self.grades.as_ref(), work)
    }

    /// Whether it is an answer: a path that was given up proposes nothing.
    fn answers(&self) -> bool {
        self.solution.status != solve::Status::Interrupted
    }
}

fn with_grades<A>(design: &Design, grades: Option<&Grades>, work: impl FnOnce(&Problem) -> A) -> A {
    let plain = design.problem();
    let Some(grades) = grades else {
        return work(&plain);
    };
    let graded = Graded {
        columns: plain.dictionary,
        grades,
    };
    work(&Problem {
        dictionary: &graded,
        ..plain
    })
}

impl Task<'_> {
    /// The gradings under which to look for this equation, plain first. Where all sets of candidates are searched and rows outnumber
    /// them, what a solver proposes matters little, and the plain norm is enough.
    pub fn gradings(&self, design: &Design) -> Vec<Grading> {
        let (rows, columns) = (design.phi.rows(), design.phi.cols());
        let searched = columns <= TERM_SELECTION.exhaustive_columns && columns < rows;
        let plain = || vec![Grading::PLAIN];
        match (self.model.norms, searched) {
            (PreferredNorms::Degree, _) => self.graded(design),
            (PreferredNorms::Plain, _) | (_, true) => plain(),
            (PreferredNorms::Any, false) => [plain(), self.graded(design)].concat(),
        }
    }

    fn graded(&self, design: &Design) -> Vec<Grading> {
        let samples = match &design.basis {
            RowKind::Samples { used, .. } => used,
            RowKind::Integrals { .. } => self.samples,
        };
        let counts = Arc::new(variations(self.library, samples));
        let bases = [GRADING.slight, GRADING.middle, GRADING.steep];
        let grading = |base| Grading {
            base,
            counts: Some(counts.clone()),
        };
        bases.map(grading).to_vec()
    }

    /// The solver's answers under these gradings, those of fewest terms first.
    pub fn proposals(
        &self,
        design: &Design,
        gradings: &[Grading],
        watcher: &mut EquationObserver,
    ) -> Vec<Proposal> {
        let of = |g: &Grading| (!g.is_plain()).then(|| grades(self.library, &|t| g.of(t)));
        let all: Vec<Option<Grades>> = gradings.iter().map(of).collect();
        let graded: Vec<Option<Graded>> = all
            .iter()
            .map(|grades| {
                let columns = design.phi.as_ref();
                grades.as_ref().map(|grades| Graded { columns, grades })
            })
            .collect();
        let plain = design.problem();
        let problems: Vec<Problem> = graded
            .iter()
            .map(|graded| Problem {
                dictionary: graded.as_ref().map_or(plain.dictionary, |g| g),
                ..plain
            })
            .collect();
        let solutions = self.options.solver.solve_all(&problems, watcher);
        let terms =
            |(problem, s): (&Problem, &Solution)| solve::support(problem, &s.coefficients).len();
        let terms: Vec<usize> = problems.iter().zip(&solutions).map(terms).collect();
        let parts = gradings.iter().zip(all).zip(solutions).zip(terms);
        let mut proposals: Vec<Proposal> = parts
            .map(|(((grading, grades), solution), terms)| Proposal {
                grading: grading.clone(),
                grades,
                solution,
                terms,
            })
            .collect();
        // A stable sort: of equals the plain norm comes first.
        proposals.sort_by_key(|p| (!p.answers(), p.terms));
        proposals
    }

    /// The proposal from which the best set of terms was selected, moved to the front, and that selection.
    pub fn best_selection(
        &self,
        design: &Design,
        proposals: &mut Vec<Proposal>,
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
                criterion,
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
