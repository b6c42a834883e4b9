//! The selection rule of one equation: under each symmetry a term must have the parity of the target, and its degree is bounded.
//!
//! In: the model's `symmetry` and `limit` statements. Out: which terms may be in the equation, and how many admitted products there are,
//! counted on the factors. Makes no product.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::library::sets::degree_bounded::{Degrees, grade};
use crate::library::sets::term_list::{TermList, size};
use crate::model::{Model, Symmetry};
use crate::term::{Parity, Signal, SignalNames, Term};
use crate::thresholds::MESSAGES;

/// One bit for each symmetry: set where a term is odd.
pub(crate) type ParityBits = u64;

/// Degree (0 if degrees are not bounded) and parities. Grades add up over products of coprime terms.
type Grade = (u64, ParityBits);

/// Which terms one equation may have.
#[derive(Clone, Debug)]
pub(crate) struct SelectionRule {
    symmetries: Vec<Symmetry>,
    /// The parities of the target.
    target_parity: ParityBits,
    degrees: Option<Degrees>,
}

impl SelectionRule {
    /// The rule that admits everything.
    pub fn none() -> SelectionRule {
        SelectionRule {
            symmetries: Vec::new(),
            target_parity: 0,
            degrees: None,
        }
    }

    pub fn of(model: &Model, target: Signal) -> SelectionRule {
        let mut rule = SelectionRule {
            symmetries: model.symmetries.clone(),
            target_parity: 0,
            degrees: model.degree.map(Degrees::up_to),
        };
        rule.target_parity = rule.parity_bits(&Term::signal(target)).unwrap_or_default();
        rule
    }

    pub fn is_none(&self) -> bool {
        self.symmetries.is_empty() && self.degrees.is_none()
    }

    pub fn target_parity(&self) -> ParityBits {
        self.target_parity
    }

    pub fn degrees(&self) -> Option<Degrees> {
        self.degrees
    }

    /// The parities of a term; `None` if it has no definite parity under some symmetry.
    pub fn parity_bits(&self, term: &Term) -> Option<ParityBits> {
        let mut signs = 0;
        for (i, symmetry) in self.symmetries.iter().enumerate() {
            match term.parity(&|s| symmetry.flips(s)) {
                Parity::Even => {}
                Parity::Odd => signs |= 1 << i,
                Parity::Neither => return None,
            }
        }
        Some(signs)
    }

    pub fn admits(&self, term: &Term) -> bool {
        self.parity_bits(term) == Some(self.target_parity)
            && self.degrees.is_none_or(|d| d.has(grade(term)))
    }

    /// The first symmetry under which a term has no definite parity.
    pub fn broken_by(&self, term: &Term) -> Option<&Symmetry> {
        let neither = |s: &&Symmetry| term.parity(&|signal| s.flips(signal)) == Parity::Neither;
        self.symmetries.iter().find(neither)
    }

    /// A list without its terms of no definite parity, since no product with them is admitted.
    pub fn with_definite_parity(&self, list: &Arc<TermList>) -> Arc<TermList> {
        if self.symmetries.is_empty() || list.terms().iter().all(|t| self.parity_bits(t).is_some())
        {
            return list.clone();
        }
        list.filtered(|t| self.parity_bits(t).is_some())
    }

    /// How many products of one term of each list the rule admits; `u128::MAX` if that does not fit. The lists must be coprime.
    pub fn size(&self, lists: &[Arc<TermList>]) -> u128 {
        if self.is_none() {
            return size(lists);
        }
        let mut counts: BTreeMap<Grade, u128> = BTreeMap::from([((0, 0), 1)]);
        for list in lists {
            let own = self.grades(list);
            let mut sum: BTreeMap<Grade, u128> = BTreeMap::new();
            for ((d, s), n) in &counts {
                for ((e, t), m) in &own {
                    // Degrees ascend, so none of the others fits either.
                    if self.degrees.is_some_and(|bound| !bound.has(d + e)) {
                        break;
                    }
                    let count = sum.entry((d + e, s ^ t)).or_default();
                    *count = count.saturating_add(n.saturating_mul(*m));
                }
            }
            counts = sum;
        }
        let admitted = counts
            .iter()
            .filter(|((_, signs), _)| *signs == self.target_parity);
        admitted.fold(0, |sum: u128, (_, n)| sum.saturating_add(*n))
    }

    fn grades(&self, list: &TermList) -> BTreeMap<Grade, u128> {
        let mut counts = BTreeMap::new();
        for term in list.terms() {
            if let Some(signs) = self.parity_bits(term) {
                let degree = self.degrees.map_or(0, |_| grade(term));
                *counts.entry((degree, signs)).or_default() += 1;
            }
        }
        counts
    }
}

/// The statements that prune a model's libraries, as printed: `symmetry y, theta; degree ≤ 4`.
pub fn restrictions(model: &Model) -> Option<String> {
    let mut parts: Vec<String> = model
        .symmetries
        .iter()
        .map(|s| format!("symmetry {}", flipped(model, s)))
        .collect();
    parts.extend(model.degree.map(|d| format!("degree ≤ {d}")));
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// The names that a symmetry flips: `y, theta`.
pub(crate) fn flipped(model: &Model, symmetry: &Symmetry) -> String {
    let names = symmetry.flipped.iter().map(|v| model.variable(*v));
    let mut shown: Vec<&str> = names.take(MESSAGES.listed_names).collect();
    if symmetry.flipped.len() > MESSAGES.listed_names {
        shown.push("…");
    }
    shown.join(", ")
}
