//! Set algebra on terms: one function an operation, sizes checked before each.

use std::collections::BTreeSet;

use super::{MAX_TERMS, errors, generator};
use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::{LibExpr, LibKind, Model, NumberArg};
use crate::lang::source::Span;
use crate::term::{Expr, Language, Signal, Term};

/// One expansion: the equation it is for, and what was found wrong on the way. `None` means an error was reported.
pub(super) struct Expansion<'a> {
    model: &'a Model,
    target: Signal,
    pub diagnostics: Vec<Diagnostic>,
}

impl<'a> Expansion<'a> {
    pub fn new(model: &'a Model, target: Signal) -> Self {
        Expansion {
            model,
            target,
            diagnostics: Vec::new(),
        }
    }

    /// The whole right side: expanded, without the bare target, sorted.
    pub fn library(&mut self, e: &LibExpr) -> Option<Vec<Term>> {
        let mut terms = self.set(e)?;
        let bare = Term::signal(self.target);
        let before = terms.len();
        terms.retain(|t| *t != bare);
        if terms.len() < before {
            self.note_target(e.span);
        }
        if terms.is_empty() {
            return self.fail(errors::empty(e.span));
        }
        // Sets come in the order of terms, and this sort is stable; degrees are never negative, so their bits are ordered.
        terms.sort_by_cached_key(|t| t.degree().to_bits());
        Some(terms)
    }

    /// Distinct terms of a set expression.
    fn set(&mut self, e: &LibExpr) -> Option<Vec<Term>> {
        match &e.kind {
            LibKind::Term(x) => Some(vec![self.column(e.span, x)?]),
            LibKind::List(items) => {
                let sets = self.each(items)?;
                Some(distinct(sets.into_iter().flatten().collect()))
            }
            LibKind::Union(a, b) => {
                let (a, b) = self.both(a, b)?;
                self.limit(e.span, a.len() as u128 + b.len() as u128)?;
                Some(distinct(a.into_iter().chain(b).collect()))
            }
            LibKind::Difference(a, b) => self.difference(e.span, a, b),
            LibKind::Product(a, b) => {
                let (a, b) = self.both(a, b)?;
                self.limit(e.span, a.len() as u128 * b.len() as u128)?;
                let all = a.iter().flat_map(|x| b.iter().map(|y| x.mul(y)));
                Some(distinct(all.collect()))
            }
            LibKind::Quotient(a, b) => {
                let a = self.set(a)?;
                let divisor = self.single(b, "/")?.pow(-1.0);
                Some(distinct(a.iter().map(|x| x.mul(&divisor)).collect()))
            }
            LibKind::Power(a, p) => Some(vec![self.single(a, "^")?.pow(*p)]),
            LibKind::Named { body, .. } => self.set(body),
            LibKind::Generate {
                name,
                name_span,
                args,
                numbers,
            } => self.generate(e.span, name, *name_span, args, numbers),
        }
    }

    fn generate(
        &mut self,
        span: Span,
        name: &str,
        name_span: Span,
        args: &[LibExpr],
        numbers: &[NumberArg],
    ) -> Option<Vec<Term>> {
        let generator = generator(name)?;
        let atoms = self.atoms(span, args)?;
        let misuse = |m| errors::misuse(name_span, generator.usage(), m);
        match generator.count(atoms.len(), numbers) {
            Ok(count) => self.limit(span, count)?,
            Err(m) => return self.fail(misuse(m)),
        }
        match generator.expand(&atoms, numbers) {
            Ok(terms) => Some(distinct(terms)),
            Err(m) => self.fail(misuse(m)),
        }
    }

    /// The arguments of a generator as distinct atoms in the order written, the target left out.
    /// Numbers stay here: `fourier(1.2*t; 1)` needs them; a generator that multiplies atoms drops them.
    fn atoms(&mut self, span: Span, args: &[LibExpr]) -> Option<Vec<Expr>> {
        let mut atoms: Vec<Expr> = Vec::new();
        let mut seen = BTreeSet::new();
        let bare = Expr::signal(self.target);
        for arg in args {
            let found = match &arg.kind {
                LibKind::Term(x) => vec![self.finite(arg.span, x)?.clone()],
                _ => self.set(arg)?.into_iter().map(Expr::from).collect(),
            };
            for atom in found {
                if atom == bare {
                    self.note_target(span);
                } else if seen.insert(atom.clone()) {
                    atoms.push(atom);
                }
            }
        }
        Some(atoms)
    }

    fn difference(&mut self, span: Span, a: &LibExpr, b: &LibExpr) -> Option<Vec<Term>> {
        let (left, right) = self.both(a, b)?;
        let gone: BTreeSet<&Term> = right.iter().collect();
        let kept: Vec<Term> = left.iter().filter(|t| !gone.contains(t)).cloned().collect();
        // Taking the target out of a shared library is no mistake, though it was dropped before.
        let takes_target = right.contains(&Term::signal(self.target));
        if kept.len() == left.len() && !takes_target {
            let language = Language(self.model);
            let single = match (left.as_slice(), right.as_slice()) {
                ([a], [b]) => Some((language.term(a), language.term(b))),
                _ => None,
            };
            let single = single.as_ref().map(|(a, b)| (a.as_str(), b.as_str()));
            return self.fail(errors::removes_nothing(span, single));
        }
        Some(kept)
    }

    /// A written expression as one column, its number dropped with a note.
    fn column(&mut self, span: Span, x: &Expr) -> Option<Term> {
        let (weight, term) = self.finite(span, x)?.clone().into_term();
        if weight == 0.0 {
            return self.fail(errors::zero_term(span));
        }
        // Minus one and the lone constant are spelling, not a loss worth a line.
        if weight.abs() != 1.0 && !term.is_one() {
            let (written, column) = (
                Language(self.model).expr(x),
                Language(self.model).term(&term),
            );
            self.diagnostics
                .push(errors::number_dropped(span, &written, &column));
        }
        Some(term)
    }

    fn finite<'x>(&mut self, span: Span, x: &'x Expr) -> Option<&'x Expr> {
        if x.is_finite() {
            Some(x)
        } else {
            self.fail(errors::not_finite(span))
        }
    }

    fn single(&mut self, e: &LibExpr, operator: &str) -> Option<Term> {
        let mut set = self.set(e)?;
        match (set.len(), set.pop()) {
            (1, Some(t)) => Some(t),
            (n, _) => self.fail(errors::needs_one_term(e.span, operator, n)),
        }
    }

    /// Both sides, so that an error in one does not hide an error in the other.
    fn both(&mut self, a: &LibExpr, b: &LibExpr) -> Option<(Vec<Term>, Vec<Term>)> {
        let (a, b) = (self.set(a), self.set(b));
        Some((a?, b?))
    }

    fn each(&mut self, items: &[LibExpr]) -> Option<Vec<Vec<Term>>> {
        let sets: Vec<Option<Vec<Term>>> = items.iter().map(|i| self.set(i)).collect();
        sets.into_iter().collect()
    }

    fn limit(&mut self, span: Span, count: u128) -> Option<()> {
        if count <= MAX_TERMS {
            return Some(());
        }
        self.fail(errors::too_many_terms(span, count))
    }

    fn note_target(&mut self, span: Span) {
        let name = crate::term::SignalNames::name(self.model, self.target);
        let note = errors::target_dropped(span, &name);
        if !self.diagnostics.contains(&note) {
            self.diagnostics.push(note);
        }
    }

    fn fail<T>(&mut self, d: Diagnostic) -> Option<T> {
        self.diagnostics.push(d);
        None
    }
}

fn distinct(mut terms: Vec<Term>) -> Vec<Term> {
    // Generators and products of sorted sets mostly come so.
    if terms.is_sorted_by(|a, b| a < b) {
        return terms;
    }
    terms.sort_unstable();
    terms.dedup();
    terms
}
