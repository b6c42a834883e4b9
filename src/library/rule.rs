//! What physical knowledge says about the terms of one equation: the parity of its target, and a bound on the degree.
//!
//! In: the model's `symmetry` and `limit` statements. Out: which terms may stand in the equation, and how many products do,
//! counted on factors.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::graded::{Degrees, grade};
use super::list::{List, size};
use crate::lang::model::{Model, Symmetry};
use crate::term::{Parity, Signal, SignalNames, Term};

/// One bit a symmetry: set where a term is odd.
pub(super) type Signs = u64;

/// Degree, where it is bounded, and signs.
type Grade = (u64, Signs);

/// What the terms of one equation must be.
#[derive(Clone, Debug)]
pub(super) struct Rule {
    symmetries: Vec<Symmetry>,
    /// The signs of the target.
    wanted: Signs,
    degrees: Option<Degrees>,
}

impl Rule {
    /// The rule that admits everything.
    pub fn none() -> Rule {
        Rule {
            symmetries: Vec::new(),
            wanted: 0,
            degrees: None,
        }
    }

    pub fn of(model: &Model, target: Signal) -> Rule {
        let mut rule = Rule {
            symmetries: model.symmetries.clone(),
            wanted: 0,
            degrees: model.degree.map(Degrees::up_to),
        };
        rule.wanted = rule.signs(&Term::signal(target)).unwrap_or_default();
        rule
    }

    pub fn is_none(&self) -> bool {
        self.symmetries.is_empty() && self.degrees.is_none()
    }

    pub fn wanted(&self) -> Signs {
        self.wanted
    }

    pub fn degrees(&self) -> Option<Degrees> {
        self.degrees
    }

    /// `None` for a term without definite parity under some symmetry.
    pub fn signs(&self, term: &Term) -> Option<Signs> {
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
        self.signs(term) == Some(self.wanted) && self.degrees.is_none_or(|d| d.has(grade(term)))
    }

    /// The first symmetry under which a term has no parity.
    pub fn broken_by(&self, term: &Term) -> Option<&Symmetry> {
        let neither = |s: &&Symmetry| term.parity(&|signal| s.flips(signal)) == Parity::Neither;
        self.symmetries.iter().find(neither)
    }

    /// A list without the terms that can stand in no product.
    pub fn definite(&self, list: &Arc<List>) -> Arc<List> {
        if self.symmetries.is_empty() || list.terms().iter().all(|t| self.signs(t).is_some()) {
            return list.clone();
        }
        list.filtered(|t| self.signs(t).is_some())
    }

    /// How many products of one term of each list the rule admits; `u128::MAX` if that does not fit. The lists must have no
    /// atoms in common.
    pub fn size(&self, lists: &[Arc<List>]) -> u128 {
        if self.is_none() {
            return size(lists);
        }
        let mut counts: BTreeMap<Grade, u128> = BTreeMap::from([((0, 0), 1)]);
        for list in lists {
            let own = self.grades(list);
            let mut sum: BTreeMap<Grade, u128> = BTreeMap::new();
            for ((d, s), n) in &counts {
                for ((e, t), m) in &own {
                    // Rising degrees: none of the others fits either.
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
            .filter(|((_, signs), _)| *signs == self.wanted);
        admitted.fold(0, |sum: u128, (_, n)| sum.saturating_add(*n))
    }

    fn grades(&self, list: &List) -> BTreeMap<Grade, u128> {
        let mut counts = BTreeMap::new();
        for term in list.terms() {
            if let Some(signs) = self.signs(term) {
                let degree = self.degrees.map_or(0, |_| grade(term));
                *counts.entry((degree, signs)).or_default() += 1;
            }
        }
        counts
    }
}

/// The statements that prune a model's libraries, as they are printed: `symmetry y, theta; degree ≤ 4`.
pub fn restrictions(model: &Model) -> Option<String> {
    let mut parts: Vec<String> = model
        .symmetries
        .iter()
        .map(|s| format!("symmetry {}", flipped(model, s)))
        .collect();
    parts.extend(model.degree.map(|d| format!("degree ≤ {d}")));
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// Names of a symmetry before they are cut short.
const SHOWN: usize = 8;

/// The names that a symmetry flips: `y, theta`.
pub(super) fn flipped(model: &Model, symmetry: &Symmetry) -> String {
    let names = symmetry.flipped.iter().map(|v| model.variable(*v));
    let mut shown: Vec<&str> = names.take(SHOWN).collect();
    if symmetry.flipped.len() > SHOWN {
        shown.push("…");
    }
    shown.join(", ")
}
