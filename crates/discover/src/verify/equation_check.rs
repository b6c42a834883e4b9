//! An equation that was found from rows: is its residual the stated one, and are its coefficients those of least squares?
//!
//! In: a [`Case`] and its rows. Out: figures in 106 bits, and claims that do not hold.

use super::messages;
use super::normal_equations::{self, NormalSolution};
use super::thresholds::VERIFICATION;
use super::tolerance::within;
use super::weighted_sums::{SumRequest, WeightedRows, WeightedSums};
use sidc_data::{Dataset, Samples};
use sidc_lang::library::Library;
use sidc_lang::term::Term;
use sidc_progress::Observer;
use sidc_system::discovery::{Discovery, Equation, Evidence, Verification, Witness};

/// Decimal digits that tell any two f64 apart.
const F64_DIGITS: f64 = 17.0;

/// What is to be checked.
#[derive(Clone, Copy)]
pub struct Case<'a> {
    /// Names of signals.
    pub names: &'a Discovery,
    pub equation: &'a Equation,
    pub library: &'a Library,
    /// The samples that the witness counts rows of.
    pub samples: &'a Samples,
    /// The readings: needed by an equation that was estimated with its trajectory.
    pub dataset: &'a Dataset,
}

/// One equation with what it is checked against.
pub(super) struct EquationCheck<'a> {
    pub case: &'a Case<'a>,
    pub evidence: &'a Evidence,
    pub witness: &'a Witness,
    pub rows: WeightedRows<'a>,
}

impl<'a> EquationCheck<'a> {
    /// Terms of one kind, with their coefficients.
    pub fn terms(&self, fixed: bool) -> Vec<(&'a Term, f64)> {
        let terms = self.case.equation.terms.iter();
        let kind = terms.filter(|t| t.fixed == fixed);
        kind.map(|t| (&t.term, t.coefficient)).collect()
    }

    /// Compares the library and the rows with what the evidence states of them.
    pub fn statements(&self, out: &mut Verification) {
        let (has, stated) = (self.case.library.len(), self.evidence.candidates);
        if has != stated {
            out.fails.push(messages::candidates(has, stated));
        }
        if self.rows.len() != self.evidence.rows {
            let text = messages::rows(self.rows.len(), self.evidence.rows);
            out.fails.push(text);
        }
        for (term, _) in self.terms(false) {
            if self.case.library.contains(term).is_none() {
                out.fails
                    .push(messages::no_candidate(self.case.names, term));
            }
        }
    }

    /// The residual, and whether the coefficients are those of least squares. `None` if the observer ended it.
    pub fn fit(&self, out: &mut Verification, observer: &mut dyn Observer) -> Option<WeightedSums> {
        let (known, found) = (self.terms(true), self.terms(false));
        let request = SumRequest {
            target: self.case.equation.target,
            known: &known,
            found: &found,
            dual: &self.witness.dual,
            gram: true,
        };
        let sums = self.rows.sums(&request, observer)?;
        let size = sums.target.value.hi;
        let contributions: Vec<f64> = (found.iter().zip(&sums.norms))
            .map(|((_, a), n)| a.abs() * n.size())
            .collect();
        let largest = contributions.iter().copied().fold(size, f64::max);
        if !sums.residual.error.is_finite() {
            out.fails.push(messages::no_value(self.case.names, &found));
            return Some(sums);
        }
        let (residual, stated) = (sums.residual.value.hi / size, self.evidence.residual);
        out.residual = Some(residual);
        let rounding = VERIFICATION.fit_rounding * largest / size + sums.residual.error / size;
        if !within(
            (residual - stated).abs(),
            VERIFICATION.residual * residual + rounding,
        ) {
            out.fails.push(messages::residual(residual, stated));
        }
        if self.evidence.certificate.constrained {
            out.open.push(messages::constrained());
        } else if !found.is_empty() {
            let normal = normal_equations::solve(&sums.gram, &sums.gradient);
            self.least_squares(&normal, &sums, largest, out);
        }
        Some(sums)
    }

    fn least_squares(
        &self,
        normal: &NormalSolution,
        sums: &WeightedSums,
        largest: f64,
        out: &mut Verification,
    ) {
        let found = self.terms(false);
        if normal.rank < found.len() {
            let text = messages::dependent(normal.rank, found.len());
            match self.evidence.certificate.rank < found.len() {
                true => out.open.push(text),
                false => out.fails.push(text),
            }
            return;
        }
        // Errors of a fit in f64 grow with the condition, and with its square times the residual (Golub & Van Loan, section 5.3).
        let condition = normal.condition;
        let residual = sums.residual.value.hi / sums.target.value.hi;
        let fitted = VERIFICATION.fit_rounding * condition * (1.0 + condition * residual) * largest;
        let mut digits = F64_DIGITS;
        for (((term, a), step), norm) in found.iter().zip(&normal.step).zip(&sums.norms) {
            let relative = (step / a).abs();
            digits = digits.min(-relative.log10());
            if step.abs() > VERIFICATION.coefficient * a.abs() + fitted / norm.size() {
                let name = messages::name(self.case.names, term);
                out.fails.push(messages::coefficient(&name, *a, a + step));
            }
        }
        out.digits = Some(digits.max(0.0)).filter(|d| d.is_finite());
    }
}
