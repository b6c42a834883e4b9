//! The certificate checked: is λ a dual point of all columns, and does it bound the 1-norm of what is proved?
//!
//! In: an equation with the sums over its rows. Out: bounds of gap, correlations and margin, and claims that they do not confirm. Rests on weak
//! duality alone: where |φ_jᵀλ| ≤ w_j for all j, every a with ‖Φa − y‖₂ ≤ ε has ‖Da‖₁ ≥ yᵀλ − ε‖λ‖₂.

use super::ball::Ball;
use super::double_double::DoubleDouble;
use super::equation_check::EquationCheck;
use super::messages;
use super::pricing::{self, Pricing};
use super::thresholds::VERIFICATION;
use super::tolerance::within;
use super::weighted_sums::{SumRequest, WeightedSums};
use sidc_lang::term::Term;
use sidc_progress::Observer;
use sidc_system::discovery::{Verification, VerifiedProof};

/// Rounding of the relative tolerance that is stated: some five units in the last place of 1.
const STATED_ROUNDING: f64 = 1e-15;

impl EquationCheck<'_> {
    /// Checks the proof, if one is claimed. `None` if the observer ended it.
    pub(super) fn certificate(
        &self,
        own: &WeightedSums,
        out: &mut Verification,
        observer: &mut dyn Observer,
    ) -> Option<()> {
        let claimed = &self.evidence.certificate;
        if claimed.constrained {
            return Some(());
        }
        if !claimed.optimal {
            out.open.push(messages::nothing_proved());
            return Some(());
        }
        if self.witness.dual.len() != self.rows.len() {
            out.fails.push(messages::no_dual());
            return Some(());
        }
        let library = self.case.library;
        let (slots, other) = match &self.witness.proposal {
            None => {
                let terms = self.terms(false);
                let slots = terms.iter().filter_map(|(t, _)| library.contains(t));
                (slots.collect(), None)
            }
            Some(proposal) => {
                out.open.push(messages::chosen(self.evidence.searched));
                let slots = proposal.iter().map(|(j, _)| *j).collect();
                (slots, Some(self.proposal_sums(proposal, observer)?))
            }
        };
        let mut support: Vec<usize> = slots;
        support.sort_unstable();
        let pricing = pricing::price(
            library,
            &self.rows,
            (&self.witness.dual, &self.witness.grading),
            &support,
            observer,
        )?;
        out.columns = pricing.columns;
        let (graded, sums) = match &other {
            Some((terms, sums)) => (self.graded(terms), sums),
            None => (self.graded(&self.terms(false)), own),
        };
        let found = self.figures(&graded, sums, &pricing);
        self.compare(&found, &pricing, out);
        out.proof = Some(found);
        Some(())
    }

    /// Coefficients times the grades of their terms.
    fn graded<T: std::borrow::Borrow<Term>>(&self, terms: &[(T, f64)]) -> Vec<f64> {
        let grade = |term: &T| self.witness.grading.of(term.borrow());
        terms.iter().map(|(term, a)| a * grade(term)).collect()
    }

    /// Terms and sums of the solver's own answer on the same rows.
    fn proposal_sums(
        &self,
        proposal: &[(usize, f64)],
        observer: &mut dyn Observer,
    ) -> Option<(Vec<(Term, f64)>, WeightedSums)> {
        let term =
            |(slot, a): &(usize, f64)| (self.case.library.term(*slot).unwrap_or_default(), *a);
        let terms: Vec<(Term, f64)> = proposal.iter().map(term).collect();
        let found: Vec<(&Term, f64)> = terms.iter().map(|(t, a)| (t, *a)).collect();
        let request = SumRequest {
            target: self.case.equation.target,
            known: &self.terms(true),
            found: &found,
            dual: &self.witness.dual,
            gram: false,
        };
        let sums = self.rows.sums(&request, observer)?;
        Some((terms, sums))
    }

    /// Bounds of all figures, from coefficients times grades, with λ scaled so that it is certainly feasible.
    fn figures(
        &self,
        coefficients: &[f64],
        sums: &WeightedSums,
        pricing: &Pricing,
    ) -> VerifiedProof {
        let parts = coefficients.iter().zip(&sums.norms);
        let primal = parts
            .map(|(a, norm)| norm.scale(a.abs()))
            .fold(Ball::exact(0.0), Ball::add);
        let scale = feasibility_scale(pricing.largest);
        let slack = sums.dual_norm.scale(self.witness.tolerance).negative();
        let dual = sums.target_dual.add(slack).over(scale);
        let difference = primal.add(dual.negative());
        let size = primal.value.hi.max(dual.value.hi);
        let (gap, rounding) = match size > 0.0 {
            true => (difference.value.to_f64() / size, difference.error / size),
            // No norm is below zero.
            false => (0.0, 0.0),
        };
        let target = sums.target.value.hi;
        let residual = sums.residual.upper() / target;
        let other = pricing.other.over(scale);
        let margin = (DoubleDouble::ONE - other.value).to_f64() - other.error;
        let optimal = (gap.abs() + rounding) <= VERIFICATION.gap && residual <= self.allowed();
        let worst = (gap + rounding).max(0.0);
        let full = self.evidence.certificate.rank == self.evidence.certificate.support;
        let elsewhere = margin > 0.0 && worst / margin <= VERIFICATION.elsewhere;
        VerifiedProof {
            gap: gap + rounding,
            max_correlation: pricing.largest.value.to_f64() + pricing.largest.error,
            margin,
            residual,
            rounding: rounding
                .max(pricing.largest.error)
                .max(other.error)
                .max(sums.residual.error / target),
            optimal,
            unique: optimal && full && elsewhere && self.witness.proposal.is_none(),
        }
    }

    /// ‖Φa − y‖/‖y‖ that counts as within the tolerance stated.
    fn allowed(&self) -> f64 {
        let tolerance = self.evidence.certificate.tolerance;
        match tolerance > 0.0 {
            true => tolerance * (1.0 + VERIFICATION.feasibility) + STATED_ROUNDING,
            false => VERIFICATION.feasibility,
        }
    }

    /// Claims that the figures do not confirm.
    fn compare(&self, found: &VerifiedProof, pricing: &Pricing, out: &mut Verification) {
        let claimed = &self.evidence.certificate;
        let at = |slot: usize| {
            let term = self.case.library.term(slot).unwrap_or_default();
            messages::name(self.case.names, &term)
        };
        if pricing.columns != self.case.library.len() {
            let text = messages::columns(pricing.columns, self.case.library.len());
            out.fails.push(text);
        }
        if let Some(slot) = pricing.unknown {
            out.fails.push(messages::unknown(&at(slot)));
        }
        if !within(
            (found.max_correlation - claimed.max_correlation).abs(),
            VERIFICATION.correlation,
        ) {
            let term = at(pricing.largest_slot);
            out.fails.push(messages::correlation(found, claimed, &term));
        }
        let allowed = self.allowed();
        if !within(found.residual, allowed) {
            out.fails.push(messages::outside(found.residual, allowed));
        }
        if !within(found.gap.abs(), VERIFICATION.gap) {
            out.fails.push(messages::gap(found.gap, VERIFICATION.gap));
        }
        if claimed.unique && claimed.of_answer && !found.unique && found.optimal {
            out.fails
                .push(messages::not_unique(found, &at(pricing.other_slot)));
        }
    }
}

/// What λ is divided by to be feasible.
fn feasibility_scale(largest: Ball) -> Ball {
    match (largest.value - DoubleDouble::ONE).to_f64() + largest.error > 0.0 {
        true => largest,
        false => Ball::ONE,
    }
}
