//! The sparsest equation that fits the rows within ε, and what becomes of the equation that the criterion selected.
//!
//! In: a design with its selection. Out: the proof, as data; where a sparser fit has no worse criterion, it is the selection from
//! then on. Never changes rows or ε.

use crate::regression::design::{Design, RowKind};
use crate::regression::estimate::Selected;
use crate::regression::task::{Task, named};
use crate::regression::thresholds::SPARSEST_ANSWER;
use crate::statistics::norm;
use sidc_progress::EquationObserver;
use sidc_solve as solve;
use sidc_solve::{Problem, Sparsest, SparsestLimits};
use sidc_system::discovery::{Discovery, SparsestProof};

/// A support that fits, with its criterion.
struct Rival {
    support: Vec<usize>,
    value: f64,
}

impl Task<'_> {
    /// Looks for the sparsest fit on the rows of the certificate. The observer may end this search alone; the search of equations
    /// goes on.
    pub fn sparsest(
        &self,
        names: &Discovery,
        design: &Design,
        selected: &mut Selected,
        watcher: &mut EquationObserver,
    ) -> SparsestProof {
        if let RowKind::Integrals { .. } = design.basis {
            return SparsestProof::refused(
                "integrals have no tolerance that all terms were tried within",
            );
        }
        if !self.library.required().is_empty() {
            return SparsestProof::refused(
                "the model requires terms, and the sparsest fit of all may lack them",
            );
        }
        let selection = selected.selection.support.clone();
        let asked = design.problem();
        let fits = solve::fits(&asked, &selection);
        // If the printed equation does not fit within ε, the tolerance is its residual: a sparser fit must be no worse.
        let tolerance = match fits {
            true => asked.tolerance,
            false => selected.polished.residual.max(asked.tolerance),
        };
        let problem = Problem { tolerance, ..asked };
        let limits = SparsestLimits {
            memory: self.options.memory,
            ..SparsestLimits::default()
        };
        let known = [selection.clone()];
        let found = solve::prove_sparsest(&problem, &known, limits, &mut watcher.aside());
        let mut proof = SparsestProof {
            refused: found.refused.clone(),
            tolerance: tolerance / norm(&design.target),
            terms: found.support.as_ref().map(Vec::len),
            lower: found.lower,
            proved: found.proved(),
            largest_term: found.largest_share,
            within: fits,
            all_others: found.all_others,
            nodes: found.nodes,
            ..SparsestProof::default()
        };
        let rivals = self.rivals(design, selected, &found);
        let fewer = found
            .support
            .as_ref()
            .is_some_and(|s| s.len() < selection.len());
        let mut printed = selection.clone();
        if let Some(best) = rivals.first().filter(|_| fewer) {
            let own = self.criterion(design, selected, &selection);
            if best.value <= own {
                proof.replaced = Some(self.words(&selection, names));
                printed.clone_from(&best.support);
                selected.replace(design, best.support.clone());
            } else {
                proof.criterion = Some(best.value - own);
            }
        }
        let others = rivals.iter().filter(|r| r.support != printed);
        let others: Vec<&Rival> = others.collect();
        proof.other_count = others.len();
        let listed = others.iter().take(SPARSEST_ANSWER.listed);
        proof.others = listed.map(|r| self.words(&r.support, names)).collect();
        proof
    }

    /// The sparsest fits that were found, the best criterion first.
    fn rivals(&self, design: &Design, selected: &Selected, found: &Sparsest) -> Vec<Rival> {
        let supports = found.support.iter().chain(&found.others);
        let mut rivals: Vec<Rival> = supports
            .map(|support| Rival {
                value: self.criterion(design, selected, support),
                support: support.clone(),
            })
            .collect();
        rivals.sort_by(|a, b| {
            a.value
                .total_cmp(&b.value)
                .then_with(|| a.support.cmp(&b.support))
        });
        rivals
    }

    fn criterion(&self, design: &Design, selected: &Selected, support: &[usize]) -> f64 {
        let fit = solve::refit(design.phi.as_ref(), &design.target, support);
        selected
            .criterion
            .value(fit.residual * fit.residual, support.len())
    }

    fn words(&self, support: &[usize], names: &Discovery) -> Vec<String> {
        named(support.iter().map(|j| self.term(*j)), names)
    }
}
