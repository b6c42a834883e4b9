//! One equation, start to end: rows, Φ, proposal, choice, polish, proof, doubts.

use std::cmp::Ordering;
use std::sync::Arc;

use super::doubts::{self, Case, Remains};
use super::memory;
use super::prepared::{Basis, Prepared};
use super::proof::prove;
use super::rows::{self, Split};
use super::strays::strays;
use super::subset::Criterion;
use super::successive;
use super::support::{self, Choice};
use super::watch::{Stage, Stop, Watcher};
use super::weights::{Weights, rms};
use super::witness::Witness;
use super::{
    Discovery, Equation, Evidence, Failed, FoundTerm, HeldOut, Method, Options, Proof, Reason,
    Status,
};
use crate::data::{Dataset, Samples};
use crate::dictionary::{BadValue, compile, subtract};
use crate::lang::model::Model;
use crate::library::Library;
use crate::solve::{self, Polished, Problem, Progress, Solution, Status as Solved};
use crate::term::{Language, Signal, SignalNames, Term};

/// What is asked.
pub(super) struct Task<'a> {
    pub target: Signal,
    pub known: Vec<(f64, Term)>,
    pub library: &'a Library,
    pub model: &'a Model,
    pub dataset: &'a Dataset,
    pub samples: &'a Samples,
    pub options: &'a Options,
}

/// Caution of a weak form that has no guess of its equation yet.
const TIED_SLACK: f64 = 0.1;

/// What the solver proposed, and what the criterion made of it.
pub(super) struct Proposed {
    pub solution: Solution,
    pub criterion: Criterion,
    pub choice: Choice,
    pub polished: Polished,
    stopped: Option<Stop>,
}

/// What is printed, and how it was come by.
pub(super) struct Answer {
    /// Columns of Φ, rising; the coefficients and their standard errors go with it.
    pub support: Vec<usize>,
    pub coefficients: Vec<f64>,
    pub standard_errors: Vec<f64>,
    pub proof: Proof,
    /// What it takes to check the proof, but for the rows.
    pub witness: Witness,
    pub ties: Vec<Vec<usize>>,
    pub searched: usize,
    pub solver: &'static str,
    /// Whether that solver can prove what it finds.
    pub exact: bool,
    /// Terms of the solver's own answer.
    pub proposed: usize,
    pub iterations: usize,
    pub status: Solved,
    pub stopped: Option<Stop>,
}

impl Proposed {
    /// (column, coefficient) of the choice.
    pub fn pairs(&self) -> Vec<(usize, f64)> {
        let columns = self.choice.support.iter().copied();
        columns
            .zip(self.polished.coefficients.iter().copied())
            .collect()
    }
}

impl Answer {
    /// (column, coefficient) of the terms.
    pub fn pairs(&self) -> Vec<(usize, f64)> {
        let columns = self.support.iter().copied();
        columns.zip(self.coefficients.iter().copied()).collect()
    }
}

impl Task<'_> {
    /// # Errors
    /// A term that the data cannot evaluate; inside, an equation that was not found.
    pub fn run(
        &self,
        names: &Discovery,
        watcher: &mut Watcher,
    ) -> Result<Result<Equation, Failed>, Box<BadValue>> {
        let mut prepared = match self.prepare(names, watcher)? {
            Ok(prepared) => prepared,
            Err(failed) => return Ok(Err(failed)),
        };
        let proposed = self.propose(&mut prepared, watcher);
        let answer = self.answer(&prepared, &proposed);
        let mut equation = self.conclude(names, &prepared, &answer);
        equation.path = self.path(&prepared, watcher);
        Ok(Ok(equation))
    }

    /// Rows, Φ, weights, tolerance.
    pub fn prepare(
        &self,
        names: &Discovery,
        watcher: &mut Watcher,
    ) -> Result<Result<Prepared, Failed>, Box<BadValue>> {
        if let Some(stop) = watcher.at(Stage::Evaluating) {
            return Ok(Err(self.failed(stop.failure())));
        }
        if self.options.method == Method::Weak
            && let Some(weak) = self.weak()?
            && let Some(whitened) = weak.whitened(&[], TIED_SLACK)
        {
            let prepared = self.prepare_weak(&weak, whitened);
            return Ok(prepared.ok_or_else(|| self.motionless(names)));
        }
        let split = rows::split(
            self.samples.len(),
            self.library.len(),
            self.options.samples,
            self.options.seed,
        );
        if let Some(reason) = memory::refuse(split.used.len(), self.library, self.options.memory) {
            return Ok(Err(self.failed(reason)));
        }
        let used = self.samples.select(&split.used);
        let y = self.target_values(&used);
        if rms(&y) == 0.0 {
            return Ok(Err(self.motionless(names)));
        }
        let weights = Weights::new(&used, self.target, self.library, &y);
        let phi = compile(self.library, &used, Some(&weights.row))?;
        let aim = product(&y, &weights.row);
        let prepared = Prepared::new(Basis::Samples { split, used, y }, weights, phi, aim);
        if let Some(stop) = watcher.at(Stage::Solving(Progress::default())) {
            return Ok(Err(self.failed(stop.failure())));
        }
        Ok(Ok(prepared))
    }

    /// The solver's terms, the criterion's choice among them, and the fit of that choice.
    pub fn propose(&self, prepared: &mut Prepared, watcher: &mut Watcher) -> Proposed {
        let problem = prepared.problem();
        let solution = watcher.solving(|monitor| self.options.solver.solve(&problem, monitor));
        let largest = largest_contribution(&problem, &solution);
        prepared.weights.seen_contribution(largest);
        let (phi, weights) = (prepared.phi.as_ref(), &prepared.weights);
        let criterion = Criterion::new(
            phi.rows(),
            weights.correlation,
            self.library.len(),
            weights.floor,
        );
        let proposals = &solution.coefficients;
        let choice = support::choose(phi, &prepared.aim, proposals, criterion, &mut || {
            watcher.at(Stage::Choosing).is_none()
        });
        let cut = choice.cut || solution.status == Solved::Interrupted;
        Proposed {
            polished: solve::polish(phi, &prepared.aim, &choice.support),
            stopped: watcher.stop().filter(|_| cut),
            solution,
            criterion,
            choice,
        }
    }

    /// The choice as it stands.
    pub fn answer(&self, prepared: &Prepared, proposed: &Proposed) -> Answer {
        let Proposed {
            solution,
            choice,
            polished,
            ..
        } = proposed;
        let (proof, witness) = prove(&prepared.problem(), solution, choice, polished);
        Answer {
            support: choice.support.clone(),
            coefficients: polished.coefficients.clone(),
            standard_errors: polished.standard_errors.clone(),
            proof,
            witness,
            ties: choice.ties.clone(),
            searched: choice.searched,
            solver: self.options.solver.name(),
            exact: self.options.solver.exact(),
            proposed: solve::support(&prepared.problem(), &solution.coefficients).len(),
            iterations: solution.iterations,
            status: solution.status.clone(),
            stopped: proposed.stopped,
        }
    }

    /// The equation with its evidence and its doubts.
    pub fn conclude(&self, names: &Discovery, prepared: &Prepared, answer: &Answer) -> Equation {
        let weights = &prepared.weights;
        let size = rms(&prepared.aim);
        let terms = self.found_terms(answer);
        let (mut witness, mut remains) = (None, Remains::default());
        let (rows, left, held_out, method) = match &prepared.basis {
            Basis::Samples { split, used, y } => {
                witness = Some(Arc::new(Witness {
                    rows: split.used.clone(),
                    weights: weights.row.clone(),
                    ..answer.witness.clone()
                }));
                let left = self.residual(&terms, used, y);
                remains.strays = strays(&left, weights, used, size);
                if self.model.discrete {
                    remains.memory = successive::memory(&left, used);
                }
                let left = rms(&product(&left, &weights.row));
                (
                    used.len(),
                    left,
                    self.held_out(&terms, split),
                    String::new(),
                )
            }
            Basis::Integrals { rows, reach } => {
                let left = rms(&prepared.problem().left(&answer.pairs()));
                let method = format!("weak form, windows of ±{reach} samples");
                (*rows, left, None, method)
            }
        };
        let evidence = Evidence {
            rows,
            candidates: self.library.len(),
            method,
            solver: answer.solver.into(),
            iterations: answer.iterations,
            residual: left / size,
            target_error: weights.target_error / size,
            held_out,
            searched: answer.searched,
            certificate: answer.proof.clone(),
            together: None,
            relation: None,
            ties: self.named(&answer.ties, names),
            halves: None,
            nearest: None,
            identifiability: None,
            verification: None,
            witness,
        };
        self.equation(names, terms, (evidence, remains), answer)
    }

    /// y without what is known.
    fn target_values(&self, samples: &Samples) -> Vec<f64> {
        let mut y = samples
            .column(self.target)
            .map_or_else(|| vec![0.0; samples.len()], |c| c.values.clone());
        subtract(&mut y, self.known.iter().map(|(c, t)| (*c, t)), samples);
        y
    }

    /// The term of a column of Φ.
    pub fn term(&self, column: usize) -> Term {
        self.library.term(column).unwrap_or_default()
    }

    /// The coefficient of a term among (column, coefficient), its known part included.
    pub fn value(&self, found: &[(usize, f64)], term: &Term) -> f64 {
        let found = found.iter().filter(|(j, _)| self.term(*j) == *term);
        let known = self.known.iter().filter(|(_, t)| t == term);
        known.map(|(value, _)| value).sum::<f64>() + found.map(|(_, a)| a).sum::<f64>()
    }

    fn found_terms(&self, answer: &Answer) -> Vec<FoundTerm> {
        let pairs = answer.pairs().into_iter();
        let errors = answer.standard_errors.iter();
        self.found(pairs.zip(errors.map(|e| e.is_finite().then_some(*e))))
    }

    /// Terms of ((column, coefficient), standard error), in the order in which they are printed.
    pub fn found(&self, all: impl Iterator<Item = ((usize, f64), Option<f64>)>) -> Vec<FoundTerm> {
        let term = |((column, coefficient), standard_error)| FoundTerm {
            term: self.term(column),
            coefficient,
            fixed: false,
            standard_error,
            trust: None,
        };
        let mut found: Vec<FoundTerm> = all.map(term).collect();
        // Products stand in the order of their lists.
        found.sort_by(|a, b| simpler(&a.term, &b.term));
        found
    }

    /// y − Σ coefficient · term on every row.
    fn residual(&self, terms: &[FoundTerm], samples: &Samples, y: &[f64]) -> Vec<f64> {
        let mut r = y.to_vec();
        let weighted = terms.iter().map(|t| (t.coefficient, &t.term));
        subtract(&mut r, weighted, samples);
        r
    }

    fn held_out(&self, terms: &[FoundTerm], split: &Split) -> Option<HeldOut> {
        if split.held.is_empty() {
            return None;
        }
        let held = self.samples.select(&split.held);
        let y = self.target_values(&held);
        let weights = Weights::new(&held, self.target, self.library, &y);
        let left = self.residual(terms, &held, &y);
        let residual = rms(&product(&left, &weights.row)) / rms(&product(&y, &weights.row));
        Some(HeldOut {
            rows: held.len(),
            residual: if residual.is_finite() {
                residual
            } else {
                f64::MAX
            },
        })
    }

    fn named(&self, supports: &[Vec<usize>], names: &Discovery) -> Vec<Vec<String>> {
        let name = |s: &Vec<usize>| named(s.iter().map(|j| self.term(*j)), names);
        supports.iter().map(name).collect()
    }

    fn equation(
        &self,
        names: &Discovery,
        terms: Vec<FoundTerm>,
        (evidence, remains): (Evidence, Remains),
        answer: &Answer,
    ) -> Equation {
        let written: Vec<String> = terms
            .iter()
            .map(|t| Language(names).term(&t.term))
            .collect();
        let reasons = doubts::weigh(&Case {
            evidence: &evidence,
            terms: &terms,
            names: &written,
            solved: &answer.status,
            stopped: answer.stopped,
            exact: answer.exact,
            proposed: answer.proposed,
            remains,
        });
        let status = if reasons.is_empty() {
            Status::Pass
        } else {
            Status::Doubt
        };
        let mut all: Vec<FoundTerm> = self.known.iter().cloned().map(super::fixed).collect();
        all.extend(terms);
        Equation {
            target: self.target,
            terms: all,
            status,
            reasons,
            evidence: Some(evidence),
            path: Vec::new(),
        }
    }

    pub fn motionless(&self, names: &Discovery) -> Failed {
        self.failed(Reason::new(
            "no-motion",
            format!(
                "{} is zero on every row (known parts taken off): there is nothing to explain",
                names.name(self.target)
            ),
        ))
    }

    pub fn failed(&self, reason: Reason) -> Failed {
        Failed {
            target: self.target,
            reasons: vec![reason],
        }
    }
}

/// Terms by name, in the order in which they are printed.
pub(super) fn named(terms: impl Iterator<Item = Term>, names: &Discovery) -> Vec<String> {
    let mut terms: Vec<Term> = terms.collect();
    terms.sort_by(simpler);
    terms.iter().map(|t| Language(names).term(t)).collect()
}

/// The order in which terms are printed.
pub(super) fn simpler(a: &Term, b: &Term) -> Ordering {
    a.degree().total_cmp(&b.degree()).then_with(|| a.cmp(b))
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

/// Root mean square of the largest coefficient · column.
fn largest_contribution(problem: &Problem, solution: &Solution) -> f64 {
    let largest = problem.shares(&solution.coefficients).fold(0.0, f64::max);
    largest / (problem.target.len() as f64).sqrt()
}
