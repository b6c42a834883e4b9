//! Whether coupled equations are independent relations, or one relation rearranged.
//!
//! In: a discovery, samples, and the tasks by which an equation can be fitted again. Out: the doubt `same-relation` with its figures
//! or, where an independent law fits nearly as well, that law in place of the copy. The fit of a single equation cannot show this:
//! θ̈ = a sin θ + b ẍ cos θ solved for ẍ fits ẍ equally well. Never changes equations that are not coupled.

mod dependence;
pub(crate) mod gradients;
mod independent_law_search;
mod messages;
pub(crate) mod thresholds;

use dependence::Dependence;
use gradients::{Gradients, SampledSignals};
use independent_law_search::IndependentLaw;
pub(crate) use independent_law_search::Refit;
use thresholds::{INDEPENDENT_LAW, REDUNDANCY};

use crate::selection::thresholds::TERM_SELECTION;
use crate::statistics::rms;
use sidc_data::Samples;
use sidc_lang::term::{Expr, Language, Signal, Term};
use sidc_system::discovery::{
    Discovery, Equation, Form, OtherLaw, Rearranged, Reason, ReasonCode, Status,
};

/// An equation as a relation.
#[derive(Clone)]
struct Relation {
    gradients: Gradients,
    /// Its unexplained part, in units of its target.
    uncertainty: f64,
}

/// Equations of which each follows from the others.
struct DependentSet {
    /// Rows of the form.
    members: Vec<usize>,
}

/// An equation of a dependent set taken as the copy, and what would replace it.
struct Replacement {
    price: f64,
    copy: usize,
    law: Option<IndependentLaw>,
    /// Whether the search for an independent law was completed.
    searched: bool,
}

/// Doubts coupled equations that are one relation, or replaces one of them by an independent law.
pub(super) fn doubt_redundant_equations(
    d: &mut Discovery,
    samples: &Samples,
    mut refit: Option<Refit>,
) {
    let form = Form::new(d);
    if form.rows.len() < 2 || !form.coupled() || samples.is_empty() {
        return;
    }
    let places: Vec<usize> = (form.unknowns.iter())
        .filter_map(|u| d.equations.iter().position(|e| e.target == *u))
        .collect();
    let tasks = refit.as_ref().map_or(&[][..], |a| a.tasks.as_slice());
    let mut signals: Vec<Signal> = tasks.iter().flat_map(|t| t.library.signals()).collect();
    for t in d.equations.iter().flat_map(|e| &e.terms) {
        t.term.for_each_signal(&mut |s| signals.push(s));
    }
    let Some(rows) = SampledSignals::new(&form, signals, samples) else {
        return;
    };
    let system = System {
        form: &form,
        places: &places,
        rows: &rows,
    };
    let Some(mut relations) = system.relations(d) else {
        return;
    };
    for case in system.dependent_sets(&relations) {
        // If an earlier replacement changed a law of this set, the set may be independent now.
        if case.members.len() > 2 || system.dependent(&case.members, &relations) {
            system.resolve(d, &case, &relations, refit.as_mut());
            relations = system.relations(d).unwrap_or(relations);
        }
    }
}

struct System<'a> {
    form: &'a Form,
    /// Place in the discovery of each row of the form.
    places: &'a [usize],
    rows: &'a SampledSignals,
}

impl System<'_> {
    fn relations(&self, d: &Discovery) -> Option<Vec<Relation>> {
        let equations = self.places.iter().map(|p| d.equations.get(*p));
        equations.map(|e| self.relation(e?)).collect()
    }

    fn relation(&self, e: &Equation) -> Option<Relation> {
        let terms = e.terms.iter().map(|t| (t.coefficient, &t.term));
        Some(Relation {
            gradients: self.rows.gradients(e.target, terms)?,
            uncertainty: self.uncertainty(e),
        })
    }

    /// The unexplained part of an equation, in units of its target: its residual. For a fitted trajectory, which satisfies the
    /// equation, instead the residual of the readings beyond their noise, combined with the standard errors of the coefficients.
    fn uncertainty(&self, e: &Equation) -> f64 {
        let Some(evidence) = &e.evidence else {
            return 0.0;
        };
        let size = self.size(e);
        if evidence.joint.is_none() {
            return evidence.residual * size;
        }
        let excess = evidence.residual.powi(2) - evidence.target_error.powi(2);
        let by_errors = e.terms.iter().map(|t| {
            let error = t.standard_error.unwrap_or(0.0);
            let values = self.rows.values_of(&Expr::from((error, t.term.clone())));
            rms(&values).powi(2)
        });
        (excess.max(0.0) * size * size + by_errors.sum::<f64>()).sqrt()
    }

    /// Root mean square of a target minus its known terms.
    fn size(&self, e: &Equation) -> f64 {
        let fixed = e.terms.iter().filter(|t| t.fixed);
        let known = fixed.map(|t| Expr::from((-t.coefficient, t.term.clone())));
        rms(&self
            .rows
            .values_of(&known.fold(Expr::signal(e.target), |sum, t| sum + t)))
    }

    /// How relation `one` depends on `others`.
    fn dependence(&self, one: &Relation, others: &[&Relation]) -> Option<Dependence> {
        let gradients: Vec<&Gradients> = others.iter().map(|o| &o.gradients).collect();
        let square = others
            .iter()
            .map(|o| (one.gradients.size / o.gradients.size * o.uncertainty).powi(2));
        let uncertainty = (one.uncertainty.powi(2) + square.sum::<f64>()).sqrt();
        Some(Dependence {
            separation: self.rows.separation(&one.gradients, &gradients)?,
            uncertainty: uncertainty.max(REDUNDANCY.rounding * one.gradients.size),
        })
    }

    /// Whether each of some equations follows from the others.
    fn dependent(&self, members: &[usize], relations: &[Relation]) -> bool {
        members.iter().all(|one| {
            let others: Vec<&Relation> = (members.iter().filter(|m| *m != one))
                .filter_map(|m| relations.get(*m))
                .collect();
            let relation = relations.get(*one);
            relation
                .and_then(|r| self.dependence(r, &others))
                .is_some_and(|l| l.is_dependent())
        })
    }

    /// Pairs that are one relation or, if there are none, a smallest set of which each follows from the others.
    fn dependent_sets(&self, relations: &[Relation]) -> Vec<DependentSet> {
        let n = self.places.len();
        let pairs = (0..n).flat_map(|b| (0..b).map(move |a| vec![a, b]));
        let tied = |m: &Vec<usize>| match m.as_slice() {
            [a, b] => self.couples(*a, *b) || self.couples(*b, *a),
            _ => true,
        };
        let pairs: Vec<DependentSet> = pairs
            .filter(tied)
            .filter(|m| self.dependent(m, relations))
            .map(|members| DependentSet { members })
            .collect();
        let among = |a: usize| (0..n).any(|b| b != a && (self.couples(a, b) || self.couples(b, a)));
        let mut all: Vec<usize> = (0..n).filter(|a| among(*a)).collect();
        if !pairs.is_empty() || all.len() < 3 {
            return pairs;
        }
        let last = |m: &[usize]| -> Option<Dependence> {
            let (one, others) = m.split_last()?;
            let others: Vec<&Relation> = others.iter().filter_map(|o| relations.get(*o)).collect();
            self.dependence(relations.get(*one)?, &others)
        };
        // Try each as the one that follows from the others; it stands last.
        for _ in 0..all.len() {
            if last(&all).is_some_and(|l| l.is_dependent()) {
                for k in (0..all.len() - 1).rev() {
                    let mut fewer = all.clone();
                    fewer.remove(k);
                    if fewer.len() > 1 && last(&fewer).is_some_and(|l| l.is_dependent()) {
                        all = fewer;
                    }
                }
                return vec![DependentSet { members: all }];
            }
            all.rotate_left(1);
        }
        Vec::new()
    }

    /// Whether row `a` of the form contains the unknown of row `b`.
    fn couples(&self, a: usize, b: usize) -> bool {
        let entry = self.form.rows.get(a).and_then(|r| r.mass.get(b));
        entry.is_some_and(|m| m.as_number() != Some(0.0))
    }

    /// Replaces one of the equations by an independent law, or doubts all of them.
    fn resolve(
        &self,
        d: &mut Discovery,
        case: &DependentSet,
        relations: &[Relation],
        mut refit: Option<&mut Refit>,
    ) {
        let mut replacements: Vec<Replacement> = Vec::new();
        for one in &case.members {
            let replacement = self.replacement(d, (case, *one), relations, refit.as_deref_mut());
            replacements.extend(replacement);
        }
        replacements.sort_by(|a, b| a.price.total_cmp(&b.price).then(b.copy.cmp(&a.copy)));
        if let Some(replacement) = replacements.into_iter().next() {
            // `None` only for places outside the discovery, which there are not.
            let _ = self.report(d, case, replacement, relations);
        }
    }

    /// One equation of a set taken as the copy; `None` if the model states it.
    fn replacement(
        &self,
        d: &Discovery,
        (case, copy): (&DependentSet, usize),
        relations: &[Relation],
        refit: Option<&mut Refit>,
    ) -> Option<Replacement> {
        let e = d.equations.get(*self.places.get(copy)?)?;
        if e.status == Status::Known {
            return None;
        }
        let others: Vec<&Relation> = (case.members.iter().filter(|m| **m != copy))
            .filter_map(|m| relations.get(*m))
            .collect();
        let independent = |terms: &[(f64, &Term)], uncertainty: f64| {
            let new = Relation {
                gradients: self.rows.gradients(e.target, terms.iter().copied())?,
                uncertainty: uncertainty * self.size(e),
            };
            self.dependence(&new, &others)?.growth_if_independent()
        };
        let (mut law, mut searched) = (None, false);
        if let Some(refit) = refit {
            law = independent_law_search::find_independent_law(refit, d, e, &independent);
            let task = refit.tasks.iter().any(|t| t.target == e.target);
            searched = task && refit.watcher.stop().is_none();
        }
        // Without an independent law, the copy is the equation with the least share of its gradient by its target.
        let share = relations.get(copy)?.gradients.share;
        Some(Replacement {
            price: law
                .as_ref()
                .map_or(INDEPENDENT_LAW.no_law_price * (1.0 + share), |l| l.price),
            copy,
            law,
            searched,
        })
    }

    /// Puts the replacement or the doubts into the discovery.
    fn report(
        &self,
        d: &mut Discovery,
        case: &DependentSet,
        Replacement {
            copy,
            law,
            searched,
            ..
        }: Replacement,
        relations: &[Relation],
    ) -> Option<()> {
        let originals: Vec<usize> = (case.members.iter().copied())
            .filter(|m| *m != copy)
            .collect();
        let others: Vec<&Relation> = originals.iter().filter_map(|m| relations.get(*m)).collect();
        let relation = relations.get(copy)?;
        let dependence = self.dependence(relation, &others)?;
        let place = *self.places.get(copy)?;
        let e = d.equations.get(place)?;
        let residual = |e: &Equation| e.evidence.as_ref().map_or(0.0, |e| e.residual);
        let before = residual(e);
        let others = originals
            .iter()
            .filter_map(|m| d.equations.get(*self.places.get(*m)?));
        let known = e.evidence.as_ref().map_or(0.0, |e| e.target_error);
        let worst = others
            .map(residual)
            .fold(known.max(INDEPENDENT_LAW.exact), f64::max);
        let message = messages::Message {
            d,
            rows: self.rows,
            form: self.form,
            copy,
            originals: &originals,
            dependence: &dependence,
            fits_worse: before > INDEPENDENT_LAW.rougher * worst,
        };
        let replaces = law.as_ref().is_some_and(|law| law.bearable(before));
        let summary = |e: &Equation, residual: f64, criterion: f64| OtherLaw {
            terms: (e.terms.iter())
                .map(|t| (Language(d).term(&t.term), t.coefficient))
                .collect(),
            residual,
            criterion,
        };
        let rearranged = Rearranged {
            of: originals.iter().map(|m| message.name(*m)).collect(),
            separation: dependence.separation.part,
            uncertainty: dependence.uncertainty / relation.gradients.size,
            condition: dependence.separation.condition,
            independent: replaces,
            other: law.as_ref().map(|law| match replaces {
                true => summary(e, before, -law.loss),
                false => summary(&law.equation, law.residual, law.loss),
            }),
        };
        let (reason, of_originals) = match &law {
            Some(law) if replaces => {
                let reason = (law.worse > TERM_SELECTION.tie)
                    .then(|| message.replaced(law.residual, before));
                (reason, None)
            }
            Some(law) => {
                let reason = message.with_worse_law(&law.equation, law.residual);
                (Some(reason), Some(message.of_originals()))
            }
            None => (
                Some(message.without_independent_law(searched)),
                Some(message.of_originals()),
            ),
        };
        if let Some(law) = law.filter(|_| replaces) {
            let e = d.equations.get_mut(place)?;
            let path = std::mem::take(&mut e.path);
            *e = Equation {
                path,
                ..law.equation
            };
        }
        let e = d.equations.get_mut(place)?;
        if let Some(evidence) = &mut e.evidence {
            evidence.relation = Some(rearranged);
        }
        doubt(e, reason);
        for place in originals.iter().filter_map(|m| self.places.get(*m)) {
            doubt(d.equations.get_mut(*place)?, of_originals.clone());
        }
        Some(())
    }
}

fn doubt(e: &mut Equation, text: Option<String>) {
    let Some(text) = text.filter(|_| e.status != Status::Known) else {
        return;
    };
    e.doubt(Reason::new(ReasonCode::SameRelation, text));
}

#[cfg(test)]
mod tests;
