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
use sidc_lang::term::Atom;
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
    /// Whether they are few beside the rows.
    pub sparse: bool,
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
        let grading = |base| Grading {
            base,
            counts: Some(counts.clone()),
            dear: None,
        };
        [GRADING.slight, GRADING.steep].map(grading).to_vec()
    }

    /// The solver's answers under these gradings, those of fewest terms first. Where none of several is sparse, the slight grading is tried
    /// with each factor of the library made dear in turn: every multiple of a law has a term with a factor of that law, so
    /// multiples go where that factor is not needed.
    pub fn proposals(
        &self,
        design: &Design,
        gradings: &[Grading],
        watcher: &mut EquationObserver,
    ) -> Vec<Proposal> {
        let mut found = self.solutions(design, gradings, usize::MAX, watcher);
        let graded = gradings.iter().find(|g| !g.is_plain());
        let sparse = found.iter().any(|p| p.sparse);
        if let Some(graded) = graded.filter(|_| !sparse && watcher.stop().is_none()) {
            let atoms = graded.counts.iter().flat_map(|counts| counts.keys());
            let dear = |atom: &Atom| Grading {
                dear: Some(atom.clone()),
                ..graded.clone()
            };
            let dear: Vec<Grading> = atoms.take(GRADING.dear).map(dear).collect();
            found.extend(self.solutions(design, &dear, GRADING.dear_steps, watcher));
        }
        // A stable sort: of equals the plain norm comes first.
        found.sort_by_key(|p| (!p.answers(), p.terms));
        found
    }

    fn solutions(
        &self,
        design: &Design,
        gradings: &[Grading],
        most_steps: usize,
        watcher: &mut EquationObserver,
    ) -> Vec<Proposal> {
        let of = |g: &Grading| (!g.is_plain()).then(|| grades(self.library, &|t| g.of(t)));
        let all: Vec<Option<Grades>> = gradings.iter().map(of).collect();
        let columns = design.phi.as_ref();
        let graded = |grades| Graded { columns, grades };
        let graded: Vec<Option<Graded>> = all.iter().map(|g| g.as_ref().map(graded)).collect();
        let plain = design.problem();
        let problems: Vec<Problem> = graded
            .iter()
            .map(|graded| Problem {
                dictionary: graded.as_ref().map_or(plain.dictionary, |g| g),
                ..plain
            })
            .collect();
        let solutions = self
            .options
            .solver
            .solve_all(&problems, most_steps, watcher);
        let facts = |(problem, s): (&Problem, &Solution)| {
            let terms = solve::support(problem, &s.coefficients).len();
            (terms, solve::is_sparse(problem, s))
        };
        let facts: Vec<(usize, bool)> = problems.iter().zip(&solutions).map(facts).collect();
        let parts = gradings.iter().zip(all).zip(solutions).zip(facts);
        parts
            .map(
                |(((grading, grades), solution), (terms, sparse))| Proposal {
                    grading: grading.clone(),
                    grades,
                    solution,
                    terms,
                    sparse,
                },
            )
            .collect()
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
