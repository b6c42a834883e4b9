//! One equation, start to end: rows, Φ, proposal, choice, polish, proof, doubts.

use super::doubts::{self, Case};
use super::memory;
use super::rows::{self, Split};
use super::subset::Criterion;
use super::support::{self, Choice};
use super::watch::{Stage, Stop, Watcher};
use super::weights::{Weights, norm, rms};
use super::{
    Discovery, Equation, Evidence, Failed, FoundTerm, HeldOut, Options, Proof, Reason, Status,
};
use crate::data::Samples;
use crate::dictionary::{BadValue, Dictionary, compile, evaluate};
use crate::library::Library;
use crate::solve::{self, Certificate, Polished, Problem, Progress, Solution, Status as Solved};
use crate::term::{Language, Signal, SignalNames, Term};

/// What is asked.
pub(super) struct Task<'a> {
    pub target: Signal,
    pub known: Vec<(f64, Term)>,
    pub library: &'a Library,
    pub samples: &'a Samples,
    pub options: &'a Options,
}

/// Smallest ε of a tall system, relative: below it, rounding decides.
const EXACT: f64 = 1e-9;
/// Room that the noise tolerance leaves over the smallest residual there is.
const ROOM: f64 = 1.001;
/// Relative residual of the whole library above which noise is plain to see.
const VISIBLE: f64 = 1e-2;

impl Task<'_> {
    /// # Errors
    /// A term that the data cannot evaluate; inside, an equation that was not found.
    pub fn run(
        &self,
        names: &Discovery,
        watcher: &mut Watcher,
    ) -> Result<Result<Equation, Failed>, Box<BadValue>> {
        if let Some(stop) = watcher.at(Stage::Evaluating) {
            return Ok(Err(self.failed(stop.failure())));
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
        let mut weights = Weights::new(&used, self.target, self.library, &y);
        let phi = compile(self.library, &used, Some(&weights.row))?;
        let phi = phi.as_ref();
        let aim = product(&y, &weights.row);
        let problem = Problem {
            dictionary: phi,
            target: &aim,
            tolerance: tolerance(phi, &aim, &mut weights),
        };
        if let Some(stop) = watcher.at(Stage::Solving(Progress::default())) {
            return Ok(Err(self.failed(stop.failure())));
        }
        let solution = watcher.solving(|monitor| self.options.solver.solve(&problem, monitor));
        weights.seen_contribution(largest_contribution(phi, &solution));
        let criterion = Criterion::new(
            used.len(),
            weights.correlation,
            self.library.len(),
            weights.floor,
        );
        let choice = support::choose(phi, &aim, &solution.coefficients, criterion, &mut || {
            watcher.at(Stage::Choosing).is_none()
        });
        let cut = choice.cut || solution.status == Solved::Interrupted;
        let stopped = watcher.stop().filter(|_| cut);
        let polished = solve::polish(phi, &aim, &choice.support);

        let proof = prove(&problem, &solution, &choice, &polished);
        let size = rms(&aim);
        let terms = self.found_terms(&choice, &polished);
        let left = self.residual(&terms, &used, &y);
        let evidence = Evidence {
            rows: used.len(),
            candidates: self.library.len(),
            solver: self.options.solver.name().into(),
            iterations: solution.iterations,
            residual: rms(&product(&left, &weights.row)) / size,
            target_error: weights.target_error / size,
            held_out: self.held_out(&terms, &split),
            searched: choice.searched,
            certificate: proof,
            ties: self.named(&choice.ties, names),
        };
        Ok(Ok(self.equation(names, terms, evidence, &solution, stopped)))
    }

    /// y without what is known.
    fn target_values(&self, samples: &Samples) -> Vec<f64> {
        let mut y = samples
            .column(self.target)
            .map_or_else(|| vec![0.0; samples.len()], |c| c.values.clone());
        subtract(&mut y, &self.known, samples);
        y
    }

    /// The term of a column of Φ.
    fn term(&self, column: usize) -> Term {
        self.library.term(column).unwrap_or_default()
    }

    fn found_terms(&self, choice: &Choice, polished: &Polished) -> Vec<FoundTerm> {
        choice
            .support
            .iter()
            .zip(&polished.coefficients)
            .zip(&polished.standard_errors)
            .map(|((j, a), e)| FoundTerm {
                term: self.term(*j),
                coefficient: *a,
                fixed: false,
                standard_error: e.is_finite().then_some(*e),
            })
            .collect()
    }

    /// y − Σ coefficient · term on every row.
    fn residual(&self, terms: &[FoundTerm], samples: &Samples, y: &[f64]) -> Vec<f64> {
        let mut r = y.to_vec();
        let weighted: Vec<(f64, Term)> = terms
            .iter()
            .map(|t| (t.coefficient, t.term.clone()))
            .collect();
        subtract(&mut r, &weighted, samples);
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
        let name = |j: &usize| Language(names).term(&self.term(*j));
        supports
            .iter()
            .map(|s| s.iter().map(name).collect())
            .collect()
    }

    fn equation(
        &self,
        names: &Discovery,
        terms: Vec<FoundTerm>,
        evidence: Evidence,
        solution: &Solution,
        stopped: Option<Stop>,
    ) -> Equation {
        let written: Vec<String> = terms
            .iter()
            .map(|t| Language(names).term(&t.term))
            .collect();
        let reasons = doubts::weigh(&Case {
            evidence: &evidence,
            terms: &terms,
            names: &written,
            solved: &solution.status,
            stopped,
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
        }
    }

    fn motionless(&self, names: &Discovery) -> Failed {
        self.failed(Reason::new(
            "no-motion",
            format!(
                "{} is zero on every row (known parts taken off): there is nothing to explain",
                names.name(self.target)
            ),
        ))
    }

    fn failed(&self, reason: Reason) -> Failed {
        Failed {
            target: self.target,
            reasons: vec![reason],
        }
    }
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

fn subtract(y: &mut [f64], terms: &[(f64, Term)], samples: &Samples) {
    for (c, term) in terms {
        let values = evaluate(term, samples);
        y.iter_mut().zip(&values).for_each(|(y, v)| *y -= c * v);
    }
}

/// ε: the data's own estimated error, or, where more rows than terms show a larger one, that.
fn tolerance(phi: &dyn Dictionary, y: &[f64], weights: &mut Weights) -> f64 {
    let (m, n) = (phi.rows(), phi.cols());
    if m <= n {
        return weights.tolerance;
    }
    let fit = solve::least_squares(phi, y);
    let size = norm(y);
    weights.seen_residual(&residual(phi, y, &fit.coefficients));
    let free = (m - fit.rank.min(m - 1)) as f64;
    let noise = fit.residual * (m as f64 / free).sqrt();
    if noise > VISIBLE * size {
        weights.seen_noise(noise / (m as f64).sqrt());
    }
    (ROOM * noise).max(weights.tolerance).max(EXACT * size)
}

/// y − Φ a.
fn residual(phi: &dyn Dictionary, y: &[f64], coefficients: &[(usize, f64)]) -> Vec<f64> {
    let mut left = y.to_vec();
    let mut column = vec![0.0; y.len()];
    for (j, a) in coefficients {
        phi.column(*j, &mut column);
        left.iter_mut().zip(&column).for_each(|(l, c)| *l -= a * c);
    }
    left
}

/// Root mean square of the largest coefficient · column.
fn largest_contribution(phi: &dyn Dictionary, solution: &Solution) -> f64 {
    let sizes = solution.coefficients.iter();
    let sizes = sizes.map(|(j, a)| a.abs() * phi.norms()[*j]);
    let largest = sizes.fold(0.0, f64::max);
    largest / (phi.rows() as f64).sqrt()
}

/// The certificate of the printed answer if it is the solver's own, else of the solver's.
fn prove(problem: &Problem, solution: &Solution, choice: &Choice, polished: &Polished) -> Proof {
    let own = certify_answer(problem, solution, choice, polished);
    let of_answer = choice.as_proposed && own.proves_optimal;
    let certificate = if of_answer {
        own
    } else {
        solve::certify(problem, &solution.coefficients, &solution.dual)
    };
    let size = norm(problem.target);
    Proof {
        tolerance: problem.tolerance / size,
        gap: finite(certificate.gap),
        max_correlation: finite(certificate.largest_correlation),
        margin: finite(certificate.margin),
        rank: polished.rank,
        support: choice.support.len(),
        condition: finite(polished.condition),
        optimal: certificate.proves_optimal,
        unique: certificate.proves_unique,
        of_answer,
    }
}

/// The polished answer with the solver's dual point, or with that point moved onto the answer's vertex if that proves more.
fn certify_answer(
    problem: &Problem,
    solution: &Solution,
    choice: &Choice,
    polished: &Polished,
) -> Certificate {
    let support = &choice.support;
    let columns = support.iter().copied();
    let answer: Vec<(usize, f64)> = columns.zip(polished.coefficients.clone()).collect();
    let signs: Vec<f64> = polished.coefficients.iter().map(|a| a.signum()).collect();
    let certify = |dual: &[f64]| solve::certify_support(problem, &answer, dual, support.clone());
    let plain = certify(&solution.dual);
    let refined = certify(&solve::refine_dual(
        problem,
        support,
        &signs,
        &solution.dual,
    ));
    if refined.gap.abs() < plain.gap.abs() {
        refined
    } else {
        plain
    }
}

/// Figures in a result must be numbers.
fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { f64::MAX }
}
