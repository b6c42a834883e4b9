//! Coupled equations judged together: are they independent relations, or one relation rearranged?
//!
//! In: a discovery, the rows, and the tasks by which an equation may be sought again. Out: the doubt `same-relation` with its
//! figures, and, where a law independent of the others does nearly as well, that law in place of the copy. Least squares cannot
//! know: θ̈ = a sin θ + b ẍ cos θ solved for ẍ fits ẍ as well. Equations that are not coupled are not touched.

mod own;
mod slopes;
mod words;

use own::Own;
use slopes::{Apart, Rows, Slopes};

use super::equation::Task;
use super::support::TIE;
use super::watch::Watcher;
use super::weights::rms;
use super::{Discovery, Equation, Form, OtherLaw, Rearranged, Reason, Status};
use crate::data::Samples;
use crate::term::{Expr, Language, Signal, Term};

/// Condition number of two equations' mass matrix from which on they may be one relation.
const CLOSE: f64 = 10.0;
/// The same from which on hardly anything of the highest derivatives is left between them.
const SINGULAR: f64 = 1e3;
/// Part of its slopes up to which a relation may be another.
const ALIKE: f64 = 0.2;
/// Two relations differ by so many times what they leave open, or by nothing that is known.
const KNOWN: f64 = 5.0;
/// Part of its slopes that is rounding and small errors of derivatives.
const ROUNDING: f64 = 1e-5;
/// Condition number up to which a law is one of its own: errors are a tenth of a relation's size, and more.
const SOUND: f64 = 30.0;
/// Residual of a law of its own, over that of the copy, up to which it is taken.
const BEARABLE: f64 = 1.5;
/// Residual over the others' from which on it is plain which equation is the copy.
const ROUGHER: f64 = 2.0;
/// Residual that is rounding.
const EXACT: f64 = 1e-9;
/// More than any law of its own costs, each row.
const UNKNOWN: f64 = 1e6;
/// Growth of its residual, where the system is solved, up to which no large part of it may be the copy.
const GROWN: f64 = 2.0;

/// What an equation may be sought again with.
pub(super) struct Again<'a, 'w, 't> {
    /// Equations that nothing ties to others.
    pub tasks: Vec<Task<'t>>,
    pub watcher: &'a mut Watcher<'w>,
}

/// An equation as a relation.
#[derive(Clone)]
struct Relation {
    slopes: Slopes,
    /// What it leaves open, in units of its target.
    open: f64,
}

/// Equations that are one relation, or of which one follows from the others.
struct Case {
    /// Rows of the form.
    members: Vec<usize>,
}

/// An equation of a case taken for the copy, and what there is instead.
struct Offer {
    price: f64,
    copy: usize,
    own: Option<Own>,
    /// Whether a law of its own was looked for to the end.
    sought: bool,
}

/// How one equation of a case stands to the others.
#[derive(Clone, Copy)]
struct Likeness {
    apart: Apart,
    /// What they leave open, in units of its target.
    open: f64,
}

impl Likeness {
    /// Alike, and nothing is left between them of the highest derivatives but what they leave open. The other signals' slopes
    /// count as alike only: a series for 1/cos θ is near it, but steeper here and there.
    fn same(&self) -> bool {
        let a = &self.apart;
        a.condition >= CLOSE && a.part <= ALIKE && a.of_unknowns <= KNOWN * self.open
    }

    /// What is left between them says nothing of the highest derivatives.
    fn idle(&self) -> bool {
        let a = &self.apart;
        a.condition >= SINGULAR && a.of_unknowns <= KNOWN * self.open
    }

    fn bad(&self) -> bool {
        self.same() || self.idle()
    }

    /// By what factor residuals grow where a law of its own is solved for.
    fn sound(&self) -> Option<f64> {
        (self.apart.condition <= SOUND && !self.bad()).then_some(self.apart.grown)
    }
}

/// Turns coupled equations that are one relation into doubts, or one of them into a law of its own.
pub(super) fn judge(d: &mut Discovery, samples: &Samples, mut again: Option<Again>) {
    let form = Form::new(d);
    if form.rows.len() < 2 || !form.coupled() || samples.is_empty() {
        return;
    }
    let places: Vec<usize> = (form.unknowns.iter())
        .filter_map(|u| d.equations.iter().position(|e| e.target == *u))
        .collect();
    let tasks = again.as_ref().map_or(&[][..], |a| a.tasks.as_slice());
    let mut signals: Vec<Signal> = tasks.iter().flat_map(|t| t.library.signals()).collect();
    for t in d.equations.iter().flat_map(|e| &e.terms) {
        t.term.for_each_signal(&mut |s| signals.push(s));
    }
    let Some(rows) = Rows::new(&form, signals, samples) else {
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
    for case in system.cases(&relations) {
        // A law that was replaced may have been part of another case.
        if case.members.len() > 2 || system.dependent(&case.members, &relations) {
            system.settle(d, &case, &relations, again.as_mut());
            relations = system.relations(d).unwrap_or(relations);
        }
    }
}

struct System<'a> {
    form: &'a Form,
    /// Place in the discovery of each row of the form.
    places: &'a [usize],
    rows: &'a Rows,
}

impl System<'_> {
    fn relations(&self, d: &Discovery) -> Option<Vec<Relation>> {
        let equations = self.places.iter().map(|p| d.equations.get(*p));
        equations.map(|e| self.relation(e?)).collect()
    }

    fn relation(&self, e: &Equation) -> Option<Relation> {
        let terms = e.terms.iter().map(|t| (t.coefficient, &t.term));
        Some(Relation {
            slopes: self.rows.slopes(e.target, terms)?,
            open: self.open(e),
        })
    }

    /// What an equation leaves of its target, or, where a trajectory was fitted and so nothing is left at all, what it leaves of
    /// the readings beyond their noise, and what the errors of its coefficients may do.
    fn open(&self, e: &Equation) -> f64 {
        let Some(evidence) = &e.evidence else {
            return 0.0;
        };
        let size = self.size(e);
        if evidence.together.is_none() {
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

    /// Root mean square of a target without what is known of it.
    fn size(&self, e: &Equation) -> f64 {
        let fixed = e.terms.iter().filter(|t| t.fixed);
        let known = fixed.map(|t| Expr::from((-t.coefficient, t.term.clone())));
        rms(&self
            .rows
            .values_of(&known.fold(Expr::signal(e.target), |sum, t| sum + t)))
    }

    /// How relation `one` stands to `others`.
    fn likeness(&self, one: &Relation, others: &[&Relation]) -> Option<Likeness> {
        let slopes: Vec<&Slopes> = others.iter().map(|o| &o.slopes).collect();
        let square = others
            .iter()
            .map(|o| (one.slopes.size / o.slopes.size * o.open).powi(2));
        let open = (one.open.powi(2) + square.sum::<f64>()).sqrt();
        Some(Likeness {
            apart: self.rows.apart(&one.slopes, &slopes)?,
            open: open.max(ROUNDING * one.slopes.size),
        })
    }

    /// Whether each of some equations follows from the others.
    fn dependent(&self, members: &[usize], relations: &[Relation]) -> bool {
        members.iter().all(|one| {
            let others: Vec<&Relation> = (members.iter().filter(|m| *m != one))
                .filter_map(|m| relations.get(*m))
                .collect();
            let own = relations.get(*one);
            own.and_then(|own| self.likeness(own, &others))
                .is_some_and(|l| l.bad())
        })
    }

    /// Pairs that are one relation; where there is none, the fewest equations of which each follows from the others.
    fn cases(&self, relations: &[Relation]) -> Vec<Case> {
        let n = self.places.len();
        let pairs = (0..n).flat_map(|b| (0..b).map(move |a| vec![a, b]));
        let tied = |m: &Vec<usize>| match m.as_slice() {
            [a, b] => self.couples(*a, *b) || self.couples(*b, *a),
            _ => true,
        };
        let pairs: Vec<Case> = pairs
            .filter(tied)
            .filter(|m| self.dependent(m, relations))
            .map(|members| Case { members })
            .collect();
        let among = |a: usize| (0..n).any(|b| b != a && (self.couples(a, b) || self.couples(b, a)));
        let mut all: Vec<usize> = (0..n).filter(|a| among(*a)).collect();
        if !pairs.is_empty() || all.len() < 3 {
            return pairs;
        }
        let last = |m: &[usize]| -> Option<Likeness> {
            let (one, others) = m.split_last()?;
            let others: Vec<&Relation> = others.iter().filter_map(|o| relations.get(*o)).collect();
            self.likeness(relations.get(*one)?, &others)
        };
        // Any of them may be the one that follows; it stands last.
        for _ in 0..all.len() {
            if last(&all).is_some_and(|l| l.bad()) {
                for k in (0..all.len() - 1).rev() {
                    let mut fewer = all.clone();
                    fewer.remove(k);
                    if fewer.len() > 1 && last(&fewer).is_some_and(|l| l.bad()) {
                        all = fewer;
                    }
                }
                return vec![Case { members: all }];
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

    /// One of the equations gets a law of its own, or all of them a doubt.
    fn settle(
        &self,
        d: &mut Discovery,
        case: &Case,
        relations: &[Relation],
        mut again: Option<&mut Again>,
    ) {
        let mut offers: Vec<Offer> = Vec::new();
        for one in &case.members {
            let offer = self.offer(d, (case, *one), relations, again.as_deref_mut());
            offers.extend(offer);
        }
        offers.sort_by(|a, b| a.price.total_cmp(&b.price).then(b.copy.cmp(&a.copy)));
        if let Some(offer) = offers.into_iter().next() {
            // Every place is one of the discovery's.
            let _ = self.tell(d, case, offer, relations);
        }
    }

    /// One equation of a case taken for the copy; `None` if the model states it.
    fn offer(
        &self,
        d: &Discovery,
        (case, copy): (&Case, usize),
        relations: &[Relation],
        again: Option<&mut Again>,
    ) -> Option<Offer> {
        let e = d.equations.get(*self.places.get(copy)?)?;
        if e.status == Status::Known {
            return None;
        }
        let others: Vec<&Relation> = (case.members.iter().filter(|m| **m != copy))
            .filter_map(|m| relations.get(*m))
            .collect();
        let independent = |terms: &[(f64, &Term)], open: f64| {
            let new = Relation {
                slopes: self.rows.slopes(e.target, terms.iter().copied())?,
                open: open * self.size(e),
            };
            self.likeness(&new, &others)?.sound()
        };
        let (mut own, mut sought) = (None, false);
        if let Some(again) = again {
            own = own::seek(again, d, e, &independent);
            let task = again.tasks.iter().any(|t| t.target == e.target);
            sought = task && again.watcher.stop().is_none();
        }
        // Without a law of its own, the one in which its target weighs least is the copy.
        let share = relations.get(copy)?.slopes.share;
        Some(Offer {
            price: own.as_ref().map_or(UNKNOWN * (1.0 + share), |o| o.price),
            copy,
            own,
            sought,
        })
    }

    /// Puts what was found into the discovery: a law of its own in place of the copy, or doubts.
    fn tell(
        &self,
        d: &mut Discovery,
        case: &Case,
        Offer {
            copy, own, sought, ..
        }: Offer,
        relations: &[Relation],
    ) -> Option<()> {
        let of: Vec<usize> = (case.members.iter().copied())
            .filter(|m| *m != copy)
            .collect();
        let others: Vec<&Relation> = of.iter().filter_map(|m| relations.get(*m)).collect();
        let relation = relations.get(copy)?;
        let likeness = self.likeness(relation, &others)?;
        let place = *self.places.get(copy)?;
        let e = d.equations.get(place)?;
        let residual = |e: &Equation| e.evidence.as_ref().map_or(0.0, |e| e.residual);
        let before = residual(e);
        let others = of
            .iter()
            .filter_map(|m| d.equations.get(*self.places.get(*m)?));
        let known = e.evidence.as_ref().map_or(0.0, |e| e.target_error);
        let worst = others.map(residual).fold(known.max(EXACT), f64::max);
        let sentence = words::Sentence {
            d,
            rows: self.rows,
            form: self.form,
            copy,
            of: &of,
            likeness: &likeness,
            rougher: before > ROUGHER * worst,
        };
        let taken = own.as_ref().is_some_and(|own| own.bearable(before));
        let law = |e: &Equation, residual: f64, criterion: f64| OtherLaw {
            terms: (e.terms.iter())
                .map(|t| (Language(d).term(&t.term), t.coefficient))
                .collect(),
            residual,
            criterion,
        };
        let rearranged = Rearranged {
            of: of.iter().map(|m| sentence.name(*m)).collect(),
            apart: likeness.apart.part,
            open: likeness.open / relation.slopes.size,
            condition: likeness.apart.condition,
            independent: taken,
            other: own.as_ref().map(|own| match taken {
                true => law(e, before, -own.loss),
                false => law(&own.equation, own.residual, own.loss),
            }),
        };
        let (reason, aside) = match &own {
            Some(own) if taken => {
                let reason = (own.worse > TIE).then(|| sentence.instead(own.residual, before));
                (reason, None)
            }
            Some(own) => {
                let reason = sentence.with_own(&own.equation, own.residual);
                (Some(reason), Some(sentence.aside()))
            }
            None => (Some(sentence.alone(sought)), Some(sentence.aside())),
        };
        if let Some(own) = own.filter(|_| taken) {
            let e = d.equations.get_mut(place)?;
            let path = std::mem::take(&mut e.path);
            *e = Equation {
                path,
                ..own.equation
            };
        }
        let e = d.equations.get_mut(place)?;
        if let Some(evidence) = &mut e.evidence {
            evidence.relation = Some(rearranged);
        }
        doubt(e, reason);
        for place in of.iter().filter_map(|m| self.places.get(*m)) {
            doubt(d.equations.get_mut(*place)?, aside.clone());
        }
        Some(())
    }
}

fn doubt(e: &mut Equation, text: Option<String>) {
    let Some(text) = text.filter(|_| e.status != Status::Known) else {
        return;
    };
    e.status = Status::Doubt;
    e.reasons.push(Reason::new("same-relation", text));
}

impl Own {
    /// Whether it is the answer in place of a copy that leaves `before` of the target.
    fn bearable(&self, before: f64) -> bool {
        let little = self.worse <= TIE || self.residual <= BEARABLE * before;
        self.grown <= GROWN && little
    }
}

#[cfg(test)]
mod tests;
