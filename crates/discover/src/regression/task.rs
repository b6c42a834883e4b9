//! The task of finding one equation, and its design matrix.
//!
//! In: a target, its known terms, a library, samples. Out: the design, and the terms that columns stand for. Never selects terms.

use std::cmp::Ordering;

use crate::dictionary::{BadValue, compile, subtract};
use crate::interruption;
use crate::options::{Method, Options};
use crate::regression::design::{Design, RowKind};
use crate::regression::memory_limit;
use crate::regression::row_sampling;
use crate::regression::thresholds::WEAK_FORM;
use crate::row_weights::Weights;
use crate::statistics::{product, rms};
use sidc_data::{Dataset, Samples};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Language, Signal, SignalNames, Term};
use sidc_progress::Stage;
use sidc_progress::{EquationObserver, SolverProgress};
use sidc_system::discovery::{Discovery, Failed, FoundTerm, Reason, ReasonCode};

/// One equation to be found: `target` = Σ known + Σ coefficient · term of the library.
pub(crate) struct Task<'a> {
    pub target: Signal,
    pub known: Vec<(f64, Term)>,
    pub library: &'a Library,
    pub model: &'a Model,
    pub dataset: &'a Dataset,
    pub samples: &'a Samples,
    pub options: &'a Options,
}

impl Task<'_> {
    /// The design matrix with weights and tolerance.
    ///
    /// # Errors
    /// A term that the data cannot evaluate; inside, why there is no problem to solve.
    pub fn design(
        &self,
        names: &Discovery,
        watcher: &mut EquationObserver,
    ) -> Result<Result<Design, Failed>, Box<BadValue>> {
        if let Some(stop) = watcher.at(Stage::Evaluating) {
            return Ok(Err(self.failed(interruption::failure(stop))));
        }
        if self.options.method == Method::Weak
            && let Some(weak) = self.weak_form()?
            && let Some(whitened) = weak.whitened(&[], WEAK_FORM.slack_without_guess)
        {
            let design = self.weak_design(&weak, whitened);
            return Ok(design.ok_or_else(|| self.motionless(names)));
        }
        let split = row_sampling::split(
            self.samples.len(),
            self.library.len(),
            self.options.samples,
            self.options.seed,
        );
        if let Some(reason) =
            memory_limit::exceeded(split.used.len(), self.library, self.options.memory)
        {
            return Ok(Err(self.failed(reason)));
        }
        let used = self.samples.select(&split.used);
        let y = self.target_values(&used);
        if rms(&y) == 0.0 {
            return Ok(Err(self.motionless(names)));
        }
        let weights = Weights::new(&used, self.target, self.library, &y);
        let phi = compile(self.library, &used, Some(&weights.row))?;
        let target = product(&y, &weights.row);
        let design = Design::new(RowKind::Samples { split, used, y }, weights, phi, target);
        if let Some(stop) = watcher.at(Stage::Solving(SolverProgress::default())) {
            return Ok(Err(self.failed(interruption::failure(stop))));
        }
        Ok(Ok(design))
    }

    /// The target minus its known terms, length M.
    pub fn target_values(&self, samples: &Samples) -> Vec<f64> {
        target_values(self.target, &self.known, samples)
    }

    /// The term of a column of Φ.
    pub fn term(&self, column: usize) -> Term {
        self.library.term(column).unwrap_or_default()
    }

    /// The coefficient of a term among (column, coefficient) pairs, known part included.
    pub fn value(&self, found: &[(usize, f64)], term: &Term) -> f64 {
        let found = found.iter().filter(|(j, _)| self.term(*j) == *term);
        let known = self.known.iter().filter(|(_, t)| t == term);
        known.map(|(value, _)| value).sum::<f64>() + found.map(|(_, a)| a).sum::<f64>()
    }

    /// Terms of ((column, coefficient), standard error) pairs, in the order in which they are printed.
    pub fn found(&self, all: impl Iterator<Item = ((usize, f64), Option<f64>)>) -> Vec<FoundTerm> {
        let term = |((column, coefficient), standard_error)| FoundTerm {
            term: self.term(column),
            coefficient,
            fixed: false,
            standard_error,
            evidence: None,
            runs: Vec::new(),
        };
        let mut found: Vec<FoundTerm> = all.map(term).collect();
        // Columns of products are in the order of their factors, not of their degree.
        found.sort_by(|a, b| simpler(&a.term, &b.term));
        found
    }

    /// y − Σ coefficient · term on every row, length M.
    pub fn residual(&self, terms: &[FoundTerm], samples: &Samples, y: &[f64]) -> Vec<f64> {
        let mut r = y.to_vec();
        let weighted = terms.iter().map(|t| (t.coefficient, &t.term));
        subtract(&mut r, weighted, samples);
        r
    }

    pub fn motionless(&self, names: &Discovery) -> Failed {
        self.failed(Reason::new(
            ReasonCode::NoMotion,
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

/// A target minus its known terms, length M.
pub(crate) fn target_values(target: Signal, known: &[(f64, Term)], samples: &Samples) -> Vec<f64> {
    let mut y = samples
        .column(target)
        .map_or_else(|| vec![0.0; samples.len()], |c| c.values.clone());
    subtract(&mut y, known.iter().map(|(c, t)| (*c, t)), samples);
    y
}

/// Names of terms, in the order in which they are printed.
pub(crate) fn named(terms: impl Iterator<Item = Term>, names: &Discovery) -> Vec<String> {
    let mut terms: Vec<Term> = terms.collect();
    terms.sort_by(simpler);
    terms.iter().map(|t| Language(names).term(t)).collect()
}

/// The order in which terms are printed: by degree, then by the terms themselves.
pub(crate) fn simpler(a: &Term, b: &Term) -> Ordering {
    a.degree().total_cmp(&b.degree()).then_with(|| a.cmp(b))
}
