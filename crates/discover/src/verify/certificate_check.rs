//! The certificate once more: is λ a dual point of all columns, and does it bound the 1-norm of what is proved?
//!
//! In: a check under way, with sums over its rows. Out: bounds of gap, correlations and margin, and what they do not show. Weak duality alone: for
//! |φ_jᵀλ| ≤ ‖φ_j‖ whatever fits within ε has ‖Da‖₁ ≥ yᵀλ − ε‖λ‖₂.

use super::columns::{self, Priced};
use super::double::Double;
use super::rows::{Asked, Sums};
use super::value::Bounded;
use super::{Check, Monitor, within, words};
use sidc_lang::term::Term;
use sidc_system::discovery::{Verification, VerifiedProof};

/// Gap, relative, up to which the 1-norm counts as the smallest.
const OPTIMAL: f64 = 1e-6;
/// Part of its 1-norm that any other minimiser may have elsewhere.
const ELSEWHERE: f64 = 1e-3;
/// Residual beyond ε, relative; with ε = 0 relative to ‖y‖.
const WITHIN: f64 = 1e-6;
/// Difference of the largest correlation from the one stated.
const STATED: f64 = 1e-6;

impl Check<'_> {
    /// The proof, if one is claimed; `None` if `monitor` ended it.
    pub(super) fn proof(&self, own: &Sums, out: &mut Verification, monitor: Monitor) -> Option<()> {
        let claimed = &self.evidence.certificate;
        if claimed.constrained {
            return Some(());
        }
        if !claimed.optimal {
            out.open.push(words::nothing_proved());
            return Some(());
        }
        if self.witness.dual.len() != self.rows.len() {
            out.fails.push(words::no_dual());
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
                out.open.push(words::chosen(self.evidence.searched));
                let slots = proposal.iter().map(|(j, _)| *j).collect();
                (slots, Some(self.proposed(proposal, &mut || monitor(0))?))
            }
        };
        let mut support: Vec<usize> = slots;
        support.sort_unstable();
        let priced = columns::price(library, &self.rows, &self.witness.dual, &support, monitor)?;
        out.columns = priced.columns;
        let (coefficients, sums) = match &other {
            Some((coefficients, sums)) => (coefficients.clone(), sums),
            None => (self.terms(false).iter().map(|(_, a)| *a).collect(), own),
        };
        let found = self.figures(&coefficients, sums, &priced);
        self.judge(&found, &priced, out);
        out.proof = Some(found);
        Some(())
    }

    /// The solver's own answer on the same rows.
    fn proposed(
        &self,
        proposal: &[(usize, f64)],
        go_on: &mut dyn FnMut() -> bool,
    ) -> Option<(Vec<f64>, Sums)> {
        let term =
            |(slot, a): &(usize, f64)| (self.case.library.term(*slot).unwrap_or_default(), *a);
        let terms: Vec<(Term, f64)> = proposal.iter().map(term).collect();
        let found: Vec<(&Term, f64)> = terms.iter().map(|(t, a)| (t, *a)).collect();
        let asked = Asked {
            target: self.case.equation.target,
            known: &self.terms(true),
            found: &found,
            dual: &self.witness.dual,
            gram: false,
        };
        let sums = self.rows.sums(&asked, go_on)?;
        Some((proposal.iter().map(|(_, a)| *a).collect(), sums))
    }

    /// Bounds of all figures, λ scaled until it is feasible beyond doubt.
    fn figures(&self, coefficients: &[f64], sums: &Sums, priced: &Priced) -> VerifiedProof {
        let parts = coefficients.iter().zip(&sums.norms);
        let primal = parts
            .map(|(a, norm)| norm.scale(a.abs()))
            .fold(Bounded::exact(0.0), Bounded::add);
        let scale = at_least_one(priced.largest);
        let given = sums.dual.scale(self.witness.tolerance).negative();
        let dual = sums.price.add(given).over(scale);
        let apart = primal.add(dual.negative());
        let size = primal.value.hi.max(dual.value.hi);
        let (gap, rounding) = match size > 0.0 {
            true => (apart.value.value() / size, apart.error / size),
            // Nothing at all has the smallest norm there is.
            false => (0.0, 0.0),
        };
        let target = sums.target.value.hi;
        let left = sums.left.most() / target;
        let off = priced.off.over(scale);
        let margin = (Double::ONE - off.value).value() - off.error;
        let optimal = (gap.abs() + rounding) <= OPTIMAL && left <= self.allowed();
        let worst = (gap + rounding).max(0.0);
        let full = self.evidence.certificate.rank == self.evidence.certificate.support;
        let elsewhere = margin > 0.0 && worst / margin <= ELSEWHERE;
        VerifiedProof {
            gap: gap + rounding,
            max_correlation: priced.largest.value.value() + priced.largest.error,
            margin,
            residual: left,
            rounding: rounding
                .max(priced.largest.error)
                .max(off.error)
                .max(sums.left.error / target),
            optimal,
            unique: optimal && full && elsewhere && self.witness.proposal.is_none(),
        }
    }

    /// ‖Φa − y‖/‖y‖ that counts as within the tolerance stated.
    fn allowed(&self) -> f64 {
        let tolerance = self.evidence.certificate.tolerance;
        match tolerance > 0.0 {
            true => tolerance * (1.0 + WITHIN) + 1e-15,
            false => WITHIN,
        }
    }

    /// What is claimed and not shown.
    fn judge(&self, found: &VerifiedProof, priced: &Priced, out: &mut Verification) {
        let claimed = &self.evidence.certificate;
        let at = |slot: usize| {
            let term = self.case.library.term(slot).unwrap_or_default();
            words::name(self.case.names, &term)
        };
        if priced.columns != self.case.library.len() {
            let text = words::columns(priced.columns, self.case.library.len());
            out.fails.push(text);
        }
        if let Some(slot) = priced.unknown {
            out.fails.push(words::unknown(&at(slot)));
        }
        if !within(
            (found.max_correlation - claimed.max_correlation).abs(),
            STATED,
        ) {
            let term = at(priced.largest_slot);
            out.fails.push(words::correlation(found, claimed, &term));
        }
        let allowed = self.allowed();
        if !within(found.residual, allowed) {
            out.fails.push(words::outside(found.residual, allowed));
        }
        if !within(found.gap.abs(), OPTIMAL) {
            out.fails.push(words::gap(found.gap, OPTIMAL));
        }
        if claimed.unique && claimed.of_answer && !found.unique && found.optimal {
            out.fails
                .push(words::not_unique(found, &at(priced.off_slot)));
        }
    }
}

/// What λ is divided by to be feasible.
fn at_least_one(largest: Bounded) -> Bounded {
    match (largest.value - Double::ONE).value() + largest.error > 0.0 {
        true => largest,
        false => Bounded::ONE,
    }
}
