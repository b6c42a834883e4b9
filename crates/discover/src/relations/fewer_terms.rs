//! Whether other laws with fewer terms span the same relations.
//!
//! In: coupled laws on rows, the libraries. Out: the laws of fewer terms, and what was searched. A law counts only if its terms all
//! are in a library or a highest derivative, if it holds on the rows as well as the equations do, and if the laws stay independent.

use std::collections::BTreeSet;

use crate::redundancy::gradients::Gradients;
use crate::relations::coupled_laws::Coupled;
use crate::relations::elimination::eliminate;
use crate::relations::multiples::{Law, Multiples, multiples};
use crate::relations::sparse_sums::{SparseSums, sparse_sums, support};
use crate::relations::thresholds::FEWER_TERMS;
use crate::statistics::rms;
use sidc_lang::library::Library;
use sidc_lang::term::{Expr, Language, Signal, Term};
use sidc_progress::Observer;
use sidc_solve as solve;
use sidc_solve::Solver;
use sidc_solve::dictionary::Dense;
use sidc_solve::threads;
use sidc_system::discovery::{FewerTerms, SparserLaw, Status};

/// The search among the sums of multiples of coupled laws.
pub(super) struct Search<'a> {
    coupled: &'a Coupled<'a>,
    libraries: &'a [Option<Library>],
    multiples: Multiples,
    /// Root mean square on the rows of each term of the multiples.
    sizes: Vec<f64>,
    /// The largest residual of an equation, over its largest term.
    residual: f64,
}

/// A law that may stand for one of the system.
struct Candidate {
    law: Law,
    /// Place of the equation that it is; `None` for a new law.
    equation: Option<usize>,
    residual: f64,
    gradients: Gradients,
}

impl<'a> Search<'a> {
    /// `None` where the equations are too noisy for it.
    pub fn new(coupled: &'a Coupled<'a>, libraries: &'a [Option<Library>]) -> Option<Search<'a>> {
        let residuals = coupled.laws.iter().map(|l| residual(coupled, l));
        let residual = residuals.fold(0.0, f64::max);
        if residual.is_nan() || residual > FEWER_TERMS.clean {
            return None;
        }
        let multiples = multiples(&coupled.laws, &factors(libraries));
        let size = |t: &Term| rms(&coupled.rows.values_of(&Expr::from(t.clone())));
        let sizes = multiples.terms.iter().map(size).collect();
        Some(Search {
            coupled,
            libraries,
            multiples,
            sizes,
            residual,
        })
    }

    /// What was found; `None` if the equations have no gradients on the rows.
    pub fn run(&self, (solver, observer): (&dyn Solver, &mut dyn Observer)) -> Option<FewerTerms> {
        let rounding = (FEWER_TERMS.room * self.residual).max(FEWER_TERMS.cancelled);
        let (columns, rows) = self.allowed(rounding);
        let pins = self.pins(&columns);
        let sums = sparse_sums(&rows, &pins, rounding, (solver, observer));
        let mut candidates = self.equations()?;
        let vectors: Vec<&Vec<f64>> = sums.vectors.iter().collect();
        let new = threads::map(vectors, |v| self.candidate(&columns, v));
        candidates.extend(new.into_iter().flatten());
        let chosen = self.chosen(candidates);
        Some(self.told(chosen, &rows, &columns, &sums))
    }

    /// The terms that a law may have, and a basis of those sums of multiples in which all other terms cancel, in units of the terms'
    /// sizes.
    fn allowed(&self, rounding: f64) -> (Vec<usize>, Vec<Vec<f64>>) {
        let (unknowns, own) = (self.coupled.unknowns(), self.own_terms());
        let in_library = |t: &Term| {
            let mut all = self.libraries.iter().flatten();
            own.contains(t) || unknowns.contains(t) || all.any(|l| l.contains(t).is_some())
        };
        let places = self.multiples.terms.iter().enumerate();
        let real = |k: usize| self.sizes.get(k).is_some_and(|s| s.is_finite() && *s > 0.0);
        let (allowed, others): (Vec<_>, Vec<_>) =
            places.partition(|(k, t)| real(*k) && in_library(t));
        // A term that is not finite on some row is not allowed in a law; it must cancel, whatever its size.
        let sizes: Vec<f64> = (0..self.sizes.len())
            .map(|k| {
                self.sizes
                    .get(k)
                    .filter(|_| real(k))
                    .copied()
                    .unwrap_or(1.0)
            })
            .collect();
        let scaled = |row: &Vec<f64>| row.iter().zip(&sizes).map(|(a, s)| a * s).collect();
        let rows: Vec<Vec<f64>> = self.multiples.rows.iter().map(scaled).collect();
        let gone: Vec<usize> = others.iter().map(|(k, _)| *k).collect();
        let columns: Vec<usize> = allowed.iter().map(|(k, _)| *k).collect();
        let kept = eliminate(rows, &gone, rounding).into_iter();
        let part = |row: Vec<f64>| {
            columns
                .iter()
                .filter_map(|c| row.get(*c).copied())
                .collect()
        };
        let rows: Vec<Vec<f64>> = kept.map(part).collect();
        // Columns in which none of the sums has a term take no part.
        let used = |k: &usize| rows.iter().any(|r| r.get(*k).is_some_and(|x| *x != 0.0));
        let used: Vec<usize> = (0..columns.len()).filter(used).collect();
        let narrow = |row: &Vec<f64>| used.iter().filter_map(|k| row.get(*k).copied()).collect();
        let rows = rows.iter().map(narrow).collect();
        let columns = used.iter().filter_map(|k| columns.get(*k).copied());
        (columns.collect(), rows)
    }

    fn own_terms(&self) -> BTreeSet<&Term> {
        self.coupled.laws.iter().flatten().map(|(_, t)| t).collect()
    }

    /// Places among `columns` of terms to solve for: those of the equations, and those with a highest derivative.
    fn pins(&self, columns: &[usize]) -> Vec<usize> {
        let own = self.own_terms();
        let unknown = |t: &Term| self.coupled.form.unknowns.iter().any(|u| t.mentions(*u));
        let rank = |k: &usize| {
            let term = columns.get(*k).and_then(|c| self.multiples.terms.get(*c));
            term.map_or(2, |t| match (own.contains(t), unknown(t)) {
                (true, true) => 0,
                (true, false) | (false, true) => 1,
                (false, false) => 2,
            })
        };
        let mut places: Vec<usize> = (0..columns.len()).filter(|k| rank(k) < 2).collect();
        places.sort_by_key(rank);
        places
    }

    fn equations(&self) -> Option<Vec<Candidate>> {
        let laws = self.coupled.laws.iter().enumerate();
        laws.map(|(k, law)| {
            Some(Candidate {
                residual: residual(self.coupled, law),
                gradients: self.gradients(law)?,
                law: law.clone(),
                equation: Some(k),
            })
        })
        .collect()
    }

    fn gradients(&self, law: &Law) -> Option<Gradients> {
        let sum: Expr = law.iter().map(|(a, t)| Expr::from((*a, t.clone()))).sum();
        let mut unknowns = self.coupled.form.unknowns.iter();
        let target = unknowns.find(|u| sum.mentions(**u))?;
        self.coupled.rows.gradients_of(&sum, *target)
    }

    /// A sum as a law, its coefficients fitted on the rows; `None` if it does not hold there, or is one of the equations.
    fn candidate(&self, columns: &[usize], v: &[f64]) -> Option<Candidate> {
        let entry = |k: usize| {
            let place = *columns.get(k)?;
            let (term, size) = (self.multiples.terms.get(place)?, self.sizes.get(place)?);
            Some((v.get(k)? / size, term.clone()))
        };
        let law: Option<Law> = support(v).map(entry).collect();
        let law = fitted(self.coupled, &law?)?;
        let terms = |l: &Law| l.iter().map(|(_, t)| t.clone()).collect::<BTreeSet<Term>>();
        let known = self.coupled.laws.iter().any(|l| terms(l) == terms(&law));
        let left = residual(self.coupled, &law);
        let bound = (FEWER_TERMS.room * self.residual).max(FEWER_TERMS.rounding);
        (!known && left <= bound).then_some(())?;
        Some(Candidate {
            residual: left,
            gradients: self.gradients(&law)?,
            law,
            equation: None,
        })
    }

    /// As many independent laws as equations, those of fewest terms first. Independent sets are a matroid, so that this order leads to the
    /// fewest terms in all (Rado 1957). Equations come before new laws of as many terms, and those that the model states before all.
    fn chosen(&self, mut candidates: Vec<Candidate>) -> Vec<Candidate> {
        let stated = |c: &Candidate| {
            let e = c.equation.and_then(|k| self.coupled.equations.get(k));
            e.is_some_and(|e| e.status == Status::Known)
        };
        candidates.sort_by_key(|c| (!stated(c), c.law.len(), c.equation.is_none()));
        let mut chosen: Vec<Candidate> = Vec::new();
        for c in candidates {
            if chosen.len() < self.coupled.laws.len() && self.independent(&c, &chosen) {
                chosen.push(c);
            }
        }
        chosen
    }

    fn independent(&self, one: &Candidate, others: &[Candidate]) -> bool {
        let others: Vec<&Gradients> = others.iter().map(|c| &c.gradients).collect();
        let own = self.coupled.rows.separation(&one.gradients, &[]);
        let apart = self.coupled.rows.separation(&one.gradients, &others);
        own.zip(apart).is_some_and(|(own, apart)| {
            own.of_unknowns > FEWER_TERMS.independent * one.gradients.size
                && apart.of_unknowns > FEWER_TERMS.independent * own.of_unknowns
        })
    }

    /// The median condition of the mass matrix of some laws.
    fn condition(&self, laws: &[&Gradients]) -> f64 {
        let split = laws.split_first();
        let apart = split.and_then(|(one, others)| self.coupled.rows.separation(one, others));
        apart.map_or(f64::MAX, |a| a.condition)
    }

    fn told(
        &self,
        chosen: Vec<Candidate>,
        rows: &[Vec<f64>],
        columns: &[usize],
        sums: &SparseSums,
    ) -> FewerTerms {
        let language = Language(self.coupled.names);
        let multipliers = self.multiples.multipliers.iter();
        FewerTerms {
            laws: self.sparser(chosen),
            multipliers: multipliers.map(|m| language.term(m)).collect(),
            multiples: self.multiples.rows.len(),
            sums: rows.len(),
            terms: columns.len(),
            exhaustive: sums.exhaustive,
            limited: self.multiples.limited || sums.stopped,
        }
    }

    /// New laws, each in the place of an equation with more terms; none if they are no whole system, or a far worse conditioned one.
    fn sparser(&self, chosen: Vec<Candidate>) -> Vec<SparserLaw> {
        if chosen.iter().all(|c| c.equation.is_some()) {
            return Vec::new();
        }
        let of_equations = self.equations().unwrap_or_default();
        let condition = |all: &[Candidate]| {
            let all: Vec<&Gradients> = all.iter().map(|c| &c.gradients).collect();
            self.condition(&all)
        };
        let whole = chosen.len() == self.coupled.laws.len();
        if !whole || condition(&chosen) > FEWER_TERMS.condition * condition(&of_equations) {
            return Vec::new();
        }
        let kept: BTreeSet<usize> = chosen.iter().filter_map(|c| c.equation).collect();
        let mut left: Vec<usize> = (0..self.coupled.laws.len())
            .filter(|k| !kept.contains(k))
            .collect();
        let mut laws = Vec::new();
        for c in chosen.iter().filter(|c| c.equation.is_none()) {
            // The equation whose target is in the law, if there is one.
            let own = |k: &usize| self.solved_for(&c.law, *k);
            let place = left.iter().position(own).unwrap_or(0);
            if place >= left.len() {
                break;
            }
            let row = left.remove(place);
            laws.extend(self.sparser_law(c, row));
        }
        laws
    }

    /// Whether the target of an equation is a term of a law.
    fn solved_for(&self, law: &Law, row: usize) -> bool {
        let target = self
            .coupled
            .form
            .unknowns
            .get(row)
            .map(|u| Term::signal(*u));
        law.iter().any(|(_, t)| Some(t) == target.as_ref())
    }

    fn sparser_law(&self, c: &Candidate, row: usize) -> Option<SparserLaw> {
        let before = self.coupled.laws.get(row)?.len();
        let left = self.left(&c.law, row)?;
        let (by, _) = c.law.iter().find(|(_, t)| *t == left)?;
        let right = c.law.iter().filter(|(_, t)| *t != left);
        let right: Law = right.map(|(a, t)| (-a / by, t.clone())).collect();
        Some(SparserLaw {
            replaces: self.coupled.name(row),
            before: before - 1,
            residual: c.residual,
            law: self.coupled.written(&left, &right),
        })
    }

    /// The term for which a law is solved: the target, else a highest derivative, else the largest term with one.
    fn left(&self, law: &Law, row: usize) -> Option<Term> {
        let target = self.coupled.form.unknowns.get(row)?;
        let size =
            |a: f64, t: &Term| rms(&self.coupled.rows.values_of(&Expr::from((a, t.clone()))));
        let mentions = |t: &Term, s: &Signal| t.mentions(*s);
        let rank = |(a, t): &&(f64, Term)| {
            let alone = self.coupled.unknowns().contains(t);
            let any = self.coupled.form.unknowns.iter().any(|u| mentions(t, u));
            (*t == Term::signal(*target), alone, any, size(*a, t))
        };
        let best = law.iter().max_by(|a, b| {
            let (x, y) = (rank(a), rank(b));
            (x.0, x.1, x.2)
                .cmp(&(y.0, y.1, y.2))
                .then(x.3.total_cmp(&y.3))
        });
        best.map(|(_, t)| t.clone())
    }
}

/// Factors of the libraries, each alone.
fn factors(libraries: &[Option<Library>]) -> BTreeSet<Term> {
    let terms = libraries.iter().flatten().flat_map(Library::factors);
    let atoms = terms.flat_map(|t| t.factors().filter(|(_, p)| *p > 0.0));
    atoms.map(|(atom, _)| Term::atom(atom.clone())).collect()
}

/// Root mean square of a sum over that of its largest term.
fn residual(coupled: &Coupled, law: &Law) -> f64 {
    let parts: Vec<Vec<f64>> = (law.iter())
        .map(|(a, t)| coupled.rows.values_of(&Expr::from((*a, t.clone()))))
        .collect();
    let largest = parts.iter().map(|p| rms(p)).fold(0.0, f64::max);
    let rows = parts.first().map_or(0, Vec::len);
    let sum = |r: usize| parts.iter().filter_map(|p| p.get(r)).sum::<f64>();
    let sums: Vec<f64> = (0..rows).map(sum).collect();
    rms(&sums) / largest
}

/// The law with coefficients of least squares, its largest term first on the left; `None` for less than two terms.
fn fitted(coupled: &Coupled, law: &Law) -> Option<Law> {
    let values = |(a, t): &(f64, Term)| coupled.rows.values_of(&Expr::from((*a, t.clone())));
    let parts: Vec<Vec<f64>> = law.iter().map(values).collect();
    let sizes: Vec<f64> = parts.iter().map(|p| rms(p)).collect();
    let largest = (0..law.len()).max_by(|a, b| {
        sizes
            .get(*a)
            .partial_cmp(&sizes.get(*b))
            .unwrap_or(std::cmp::Ordering::Equal)
    })?;
    let others: Vec<usize> = (0..law.len()).filter(|k| *k != largest).collect();
    let target: Vec<f64> = parts.get(largest)?.iter().map(|x| -x).collect();
    let columns: Vec<f64> = others
        .iter()
        .filter_map(|k| parts.get(*k))
        .flatten()
        .copied()
        .collect();
    if others.is_empty() || target.len() <= others.len() || !columns.iter().all(|x| x.is_finite()) {
        return None;
    }
    let phi = Dense::new(target.len(), columns);
    let all: Vec<usize> = (0..others.len()).collect();
    let fit = solve::refit(&phi, &target, &all);
    let mut out: Law = vec![law.get(largest)?.clone()];
    for (k, factor) in others.iter().zip(fit.coefficients) {
        let (a, t) = law.get(*k)?;
        out.push((a * factor, t.clone()));
    }
    Some(out)
}
