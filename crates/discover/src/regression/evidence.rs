//! The equation of an estimate, with its evidence and its doubts.
//!
//! In: a design and an estimate on it. Out: the equation. Never changes the estimate.

use std::sync::Arc;

use crate::doubts::badly_fitted_rows::{badly_fitted_rows, median_miss};
use crate::doubts::regression_rules::{self, RegressionCase, ResidualFindings};
use crate::doubts::residual_autocorrelation;
use crate::known_terms::fixed;
use crate::regression::design::{Design, RowKind};
use crate::regression::estimate::Estimate;
use crate::regression::row_sampling::Split;
use crate::regression::task::{Task, named};
use crate::row_weights::Weights;
use crate::statistics::{product, rms};
use crate::uncertainty::term_identity::same_laws;
use sidc_lang::term::{Language, Term};
use sidc_system::discovery::{
    Discovery, Equation, Evidence, FoundTerm, HeldOut, RowOrigin, Status, Witness,
};

impl Task<'_> {
    /// The equation of an estimate. `names` gives signals their names.
    pub fn conclude(&self, names: &Discovery, design: &Design, answer: &Estimate) -> Equation {
        let weights = &design.weights;
        let size = rms(&design.target);
        let terms = self.found_terms(answer);
        let (mut witness, mut remains) = (None, ResidualFindings::default());
        let (rows, left, held_out, origin) = match &design.basis {
            RowKind::Samples { split, used, y } => {
                witness = Some(Arc::new(Witness {
                    rows: split.used.clone(),
                    weights: weights.row.clone(),
                    ..answer.witness.clone()
                }));
                let left = self.residual(&terms, used, y);
                remains.badly_fitted = badly_fitted_rows(&left, weights, used, size);
                remains.median_miss = median_miss(&left, weights);
                if self.model.discrete {
                    remains.autocorrelation = residual_autocorrelation::measure(&left, used);
                }
                let left = rms(&product(&left, &weights.row));
                let held_out = self.held_out(&terms, split);
                (used.len(), left, held_out, RowOrigin::Samples)
            }
            RowKind::Integrals { rows, reach } => {
                let left = rms(&design.problem().residual(&answer.pairs()));
                let origin = RowOrigin::Integrals { reach: *reach };
                (*rows, left, None, origin)
            }
        };
        let evidence = Evidence {
            rows,
            candidates: self.library.len(),
            origin,
            solver: answer.solver.into(),
            iterations: answer.iterations,
            residual: left / size,
            target_error: weights.target_error / size,
            held_out,
            searched: answer.searched,
            certificate: answer.proof.clone(),
            certificate_range: Vec::new(),
            joint: None,
            relation: None,
            methods: None,
            ties: self.named(&self.other_laws(answer), names),
            halves: None,
            omitted: None,
            identifiability: None,
            verification: None,
            sparsest: None,
            witness,
        };
        self.equation(names, terms, (evidence, remains), answer)
    }

    fn found_terms(&self, answer: &Estimate) -> Vec<FoundTerm> {
        let pairs = answer.pairs().into_iter();
        let errors = answer.standard_errors.iter();
        self.found(pairs.zip(errors.map(|e| e.is_finite().then_some(*e))))
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

    /// The tied supports that are no other words for the law found.
    fn other_laws(&self, answer: &Estimate) -> Vec<Vec<usize>> {
        let terms = |s: &[usize]| -> Vec<Term> { s.iter().map(|j| self.term(*j)).collect() };
        let found = terms(&answer.support);
        let ties = answer
            .ties
            .iter()
            .filter(|s| !same_laws(&found, &terms(s), self.model));
        ties.cloned().collect()
    }

    fn named(&self, supports: &[Vec<usize>], names: &Discovery) -> Vec<Vec<String>> {
        let name = |s: &Vec<usize>| named(s.iter().map(|j| self.term(*j)), names);
        supports.iter().map(name).collect()
    }

    fn equation(
        &self,
        names: &Discovery,
        terms: Vec<FoundTerm>,
        (evidence, remains): (Evidence, ResidualFindings),
        answer: &Estimate,
    ) -> Equation {
        let written: Vec<String> = terms
            .iter()
            .map(|t| Language(names).term(&t.term))
            .collect();
        let reasons = regression_rules::doubts(&RegressionCase {
            evidence: &evidence,
            terms: &terms,
            names: &written,
            solved: &answer.status,
            stopped: answer.stopped,
            exact: answer.exact,
            proposed: answer.proposed,
            residuals: remains,
        });
        let status = if reasons.is_empty() {
            Status::Pass
        } else {
            Status::Doubt
        };
        let mut all: Vec<FoundTerm> = self.known.iter().cloned().map(fixed).collect();
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
}
