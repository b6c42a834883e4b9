//! A solver's answers to one problem in several norms.
//!
//! In: a problem, its library and samples. Out: an answer in each norm, those of fewest terms first. Selects nothing.

use std::sync::Arc;

use crate::dictionary::{grades, variations};
use crate::regression::thresholds::GRADING;
use sidc_data::Samples;
use sidc_lang::library::{Grading, Library};
use sidc_lang::term::Atom;
use sidc_progress::Observer;
use sidc_solve as solve;
use sidc_solve::dictionary::{Graded, Grades};
use sidc_solve::{Problem, Solution, Solver};

/// The answer of a solver in one norm.
pub struct Proposal {
    pub grading: Grading,
    /// `None` in the plain norm.
    pub grades: Option<Grades>,
    pub solution: Solution,
    /// Number of terms whose coefficients are more than rounding.
    pub terms: usize,
    /// Whether the terms are few compared with the rows.
    pub sparse: bool,
}

/// One problem, to be solved in several norms.
pub struct NormSearch<'a> {
    pub library: &'a Library,
    /// Signals on the rows, from which the variation of the library's factors follows.
    pub samples: &'a Samples,
    /// In the plain norm.
    pub problem: Problem<'a>,
    pub solver: &'a dyn Solver,
}

impl Proposal {
    /// Calls `work` with the problem, in the norm that this proposal answers.
    pub fn with_problem<A>(&self, plain: &Problem, work: impl FnOnce(&Problem) -> A) -> A {
        let Some(grades) = &self.grades else {
            return work(plain);
        };
        let graded = Graded {
            columns: plain.dictionary,
            grades,
        };
        work(&Problem {
            dictionary: &graded,
            ..*plain
        })
    }

    /// Whether it is an answer: a path that was given up proposes nothing.
    pub fn answers(&self) -> bool {
        self.solution.status != solve::Status::Interrupted
    }
}

impl NormSearch<'_> {
    /// The graded norms: κ for each degree, each factor counted by how much it varies.
    pub fn graded(&self) -> Vec<Grading> {
        let counts = Arc::new(variations(self.library, self.samples));
        let grading = |base| Grading {
            base,
            counts: Some(counts.clone()),
            penalized: None,
        };
        [GRADING.slight, GRADING.steep].map(grading).to_vec()
    }

    /// The plain norm and the graded ones.
    pub fn every_norm(&self) -> Vec<Grading> {
        let mut all = vec![Grading::PLAIN];
        all.extend(self.graded());
        all
    }

    /// Answers in these norms, those of fewest terms first.
    ///
    /// If no norm leads to a sparse answer within the step limit, the first graded norm is tried with the terms of one factor of
    /// the library made expensive, for each factor in turn. Reason: every multiple of a law by a factor has terms with that factor,
    /// so making it expensive favours the law itself. If this fails too, the path of the first norm is followed to its end, which
    /// takes longest because it fits noise.
    pub fn proposals(&self, gradings: &[Grading], observer: &mut dyn Observer) -> Vec<Proposal> {
        let alone = gradings.len() < 2 && gradings.iter().all(Grading::is_plain);
        let most_steps = if alone { usize::MAX } else { GRADING.steps };
        let mut found = self.solutions(gradings, most_steps, observer);
        let many = !alone && self.solver.gives_up();
        if many && none_sparse(&found) && observer.go_on() {
            found.extend(self.solutions(&penalized(gradings), most_steps, observer));
        }
        if none_sparse(&found) && observer.go_on() {
            // The plain norm, unless the model prefers others.
            let first = found.first().filter(|p| !p.answers());
            let first: Vec<Grading> = first.map(|p| p.grading.clone()).into_iter().collect();
            found.extend(self.solutions(&first, usize::MAX, observer));
        }
        // On equal numbers of terms the plain norm comes first, then the smaller κ. Paths that a stop interrupted come after
        // answers, but before those that were given up without any.
        found.sort_by(|a, b| {
            let nothing = |p: &Proposal| p.solution.coefficients.is_empty();
            let penalized = |p: &Proposal| p.grading.penalized.is_some();
            let key = |p: &Proposal| (!p.answers(), nothing(p), p.terms, penalized(p));
            let bases = a.grading.base.total_cmp(&b.grading.base);
            key(a).cmp(&key(b)).then(bases)
        });
        found
    }

    fn solutions(
        &self,
        gradings: &[Grading],
        most_steps: usize,
        observer: &mut dyn Observer,
    ) -> Vec<Proposal> {
        let of = |g: &Grading| (!g.is_plain()).then(|| grades(self.library, &|t| g.of(t)));
        let all: Vec<Option<Grades>> = gradings.iter().map(of).collect();
        let columns = self.problem.dictionary;
        let graded = |grades| Graded { columns, grades };
        let graded: Vec<Option<Graded>> = all.iter().map(|g| g.as_ref().map(graded)).collect();
        let problems: Vec<Problem> = graded
            .iter()
            .map(|graded| Problem {
                dictionary: graded.as_ref().map_or(columns, |g| g),
                ..self.problem
            })
            .collect();
        let solutions = self.solver.solve_all(&problems, most_steps, observer);
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
}

fn none_sparse(found: &[Proposal]) -> bool {
    !found.iter().any(|p| p.sparse)
}

/// The first graded norm with the terms of each factor made expensive in turn; none where all norms are plain.
fn penalized(gradings: &[Grading]) -> Vec<Grading> {
    let Some(graded) = gradings.iter().find(|g| !g.is_plain()) else {
        return Vec::new();
    };
    let penalized = |atom: &Atom| Grading {
        penalized: Some(atom.clone()),
        ..graded.clone()
    };
    let atoms = graded.counts.iter().flat_map(|counts| counts.keys());
    atoms.take(GRADING.penalized).map(penalized).collect()
}
