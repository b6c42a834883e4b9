//! An equation that the model gives, judged on rows as one that was found.
//!
//! In: a task without candidates. Out: the equation, doubted where it leaves more than the errors of the rows. Estimates nothing: its constants
//! have their values.

use crate::doubts::badly_fitted_rows::{badly_fitted_rows, median_miss};
use crate::doubts::regression_rules::{self, RegressionCase, ResidualFindings};
use crate::doubts::residual_autocorrelation;
use crate::known_terms::fixed;
use crate::regression::task::Task;
use crate::row_weights::Weights;
use crate::statistics::{product, rms};
use sidc_data::{Column, Origin};
use sidc_lang::library::Library;
use sidc_lang::term::{Signal, SignalNames};
use sidc_solve::Status as Solved;
use sidc_system::discovery::{Equation, Evidence, FoundTerm, Status};

impl Task<'_> {
    /// The given equation with what its residual shows.
    pub fn judge_given(&self) -> Equation {
        let terms: Vec<FoundTerm> = self.known.iter().cloned().map(fixed).collect();
        let rows = self.samples;
        let target = match rows.column(self.target) {
            Some(column) => &column.values[..],
            None => &[],
        };
        // Errors of the signals in its terms count as those of candidates do.
        let stated = Library::listed(self.known.iter().map(|(_, t)| t.clone()).collect());
        let weights = Weights::new(rows, self.target, &stated, target);
        let size = rms(&product(target, &weights.row)).max(f64::MIN_POSITIVE);
        let left = self.target_values(rows);
        // Errors of estimated derivatives follow each other whatever the law is.
        let is_measured = |c: &Column| matches!(c.origin, Origin::Measured { .. });
        let white = rows.columns.iter().all(is_measured);
        let autocorrelation = match white {
            true => residual_autocorrelation::measure(&left, rows),
            false => None,
        };
        let residuals = ResidualFindings {
            badly_fitted: badly_fitted_rows(&left, &weights, rows, size),
            median_miss: median_miss(&left, &weights),
            autocorrelation,
        };
        let evidence = Evidence {
            rows: rows.len(),
            residual: rms(&product(&left, &weights.row)) / size,
            target_error: weights.target_error / size,
            ..Evidence::default()
        };
        let mut reasons = regression_rules::residual_doubts(&RegressionCase {
            evidence: &evidence,
            terms: &terms,
            names: &[],
            solved: &Solved::Solved,
            stopped: None,
            exact: true,
            proposed: 0,
            residuals,
        });
        let follows = |s: &Signal| {
            let along = residual_autocorrelation::along(&left, &rows.column(*s)?.values)?;
            regression_rules::lack_of_fit(&evidence, &self.model.name(*s), along)
        };
        if white && reasons.is_empty() {
            reasons.extend(stated.signals().iter().find_map(follows));
        }
        let status = match reasons.is_empty() {
            true => Status::Pass,
            false => Status::Doubt,
        };
        Equation {
            target: self.target,
            terms,
            status,
            reasons,
            evidence: Some(evidence),
            path: Vec::new(),
        }
    }
}
