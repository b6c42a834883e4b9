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
use super::watch::Watcher;
use super::weights::rms;
use super::{Discovery, Equation, Form, OtherLaw, Reason, Rearranged, Status};
use crate::data::Samples;
use crate::term::{Expr, Language, Signal, SignalNames, Term};

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
/// Criterion that a law of its own may lose without being a doubtful choice: odds of e³ to 1, a tie.
const TIE: f64 = 6.0;
/// Residual of a law of its own, over that of the copy, up to which it is taken.
const BEARABLE: f64 = 1.2;

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

/// How one equation of a case stands to the others.
#[derive(Clone, Copy)]
struct Likeness {
    apart: Apart,
    /// What they leave open, in the units of `apart.distance`.
    open: f64,
}

impl Likeness {
    /// Nothing is left between the relations but what they leave open.
    fn same(&self) -> bool {
        let a = &self.apart;
        a.condition >= CLOSE && a.part <= ALIKE && a.distance <= KNOWN * self.open
    }

    /// What is left between them says nothing of the highest derivatives.
    fn idle(&self) -> bool {
        let a = &self.apart;
        a.condition >= SINGULAR && a.of_unknowns <= KNOWN * self.open
    }

    fn bad(&self) -> bool {
        self.same() || self.idle()
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
    let Some(relations) = system.relations(d) else {
        return;
    };
    for case in system.cases(&relations) {
        system.settle(d, &case, &relations, again.as_mut());
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
        rms(&self.rows.values_of(&known.fold(Expr::signal(e.target), |sum, t| sum + t)))
    }

    /// How relation `one` stands to `others`.
    fn likeness(&self, one: &Relation, others: &[&Relation]) -> Option<Likeness> {
        let slopes: Vec<&Slopes> = others.iter().map(|o| &o.slopes).collect();
        let square = others.iter().map(|o| (one.slopes.size / o.slopes.size * o.open).powi(2));
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
        again: Option<&mut Again>,
    ) {
        let mut offers: Vec<(f64, usize, Option<Own>)> = Vec::new();
        let mut again = again;
        for one in &case.members {
            let Some(e) = self.places.get(*one).and_then(|p| d.equations.get(*p)) else {
                continue;
            };
            let others: Vec<&Relation> = (case.members.iter().filter(|m| *m != one))
                .filter_map(|m| relations.get(*m))
                .collect();
            let own = again.as_deref_mut().and_then(|again| {
                let independent = |terms: &[(f64, &Term)], open: f64| {
                    let slopes = self.rows.slopes(e.target, terms.iter().copied());
                    let new = slopes.map(|slopes| Relation {
                        slopes,
                        open: open * self.size(e),
                    });
                    let likeness = new.and_then(|new| self.likeness(&new, &others));
                    likeness.is_some_and(|l| !l.bad())
                };
                own::seek(again, d, e, &independent)
            });
            // Without a law of its own, the one that fits worse is the copy.
            let residual = e.evidence.as_ref().map_or(0.0, |e| e.residual);
            let price = own.as_ref().map_or(f64::MAX / 2.0 / (1.0 + residual), |o| o.price);
            offers.push((price, *one, own));
        }
        offers.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let Some((_, copy, own)) = offers.into_iter().next() else {
            return;
        };
        self.tell(d, case, copy, own, relations);
    }

    /// Puts what was found into the discovery.
    fn tell(
        &self,
        d: &mut Discovery,
        case: &Case,
        copy: usize,
        own: Option<Own>,
        relations: &[Relation],
    ) {
        let of: Vec<usize> = case.members.iter().copied().filter(|m| *m != copy).collect();
        let others: Vec<&Relation> = of.iter().filter_map(|m| relations.get(*m)).collect();
        let likeness = relations.get(copy).and_then(|r| self.likeness(r, &others));
        let (Some(likeness), Some(place)) = (likeness, self.places.get(copy).copied()) else {
            return;
        };
        let Some(e) = d.equations.get(place) else {
            return;
        };
        let size = relations.get(copy).map_or(1.0, |r| r.slopes.size);
        let mut rearranged = Rearranged {
            of: of.iter().filter_map(|m| self.form.unknowns.get(*m)).map(|s| d.name(*s)).collect(),
            apart: likeness.apart.part,
            open: likeness.open / size,
            condition: likeness.apart.condition,
            independent: false,
            other: None,
        };
        let sentence = words::Sentence {
            d,
            rows: self.rows,
            form: self.form,
            copy,
            of: &of,
            likeness: &likeness,
        };
        let Some(own) = own else {
            let reason = Reason::new("same-relation", sentence.alone(e.evidence.as_ref()));
            self.attach(d, case, reason, (place, rearranged));
            return;
        };
        let before = e.evidence.as_ref().map_or(0.0, |e| e.residual);
        let law = |e: &Equation, residual: f64, criterion: f64| OtherLaw {
            terms: (e.terms.iter())
                .map(|t| (Language(d).term(&t.term), t.coefficient))
                .collect(),
            residual,
            criterion,
        };
        let residual = own.residual;
        let tie = own.loss <= TIE;
        if !tie && residual > BEARABLE * before {
            rearranged.other = Some(law(&own.equation, residual, own.loss));
            let reason = Reason::new("same-relation", sentence.with_own(&own.equation, residual));
            self.attach(d, case, reason, (place, rearranged));
            return;
        }
        rearranged.independent = true;
        rearranged.other = Some(law(e, before, -own.loss));
        let reason = (!tie).then(|| Reason::new("same-relation", sentence.instead(residual, before)));
        let mut equation = own.equation;
        equation.path = e.path.clone();
        if let Some(evidence) = &mut equation.evidence {
            evidence.relation = Some(rearranged);
        }
        if let Some(reason) = reason {
            equation.status = Status::Doubt;
            equation.reasons.push(reason);
        }
        if let Some(e) = d.equations.get_mut(place) {
            *e = equation;
        }
    }

    fn attach(
        &self,
        d: &mut Discovery,
        case: &Case,
        reason: Reason,
        (copy, rearranged): (usize, Rearranged),
    ) {
        let copied = d.equations.get_mut(copy).and_then(|e| e.evidence.as_mut());
        if let Some(evidence) = copied {
            evidence.relation = Some(rearranged);
        }
        let places = case.members.iter().filter_map(|m| self.places.get(*m));
        for place in places {
            let equation = d.equations.get_mut(*place);
            if let Some(e) = equation.filter(|e| e.status != Status::Known) {
                e.status = Status::Doubt;
                e.reasons.push(reason.clone());
            }
        }
    }
}
