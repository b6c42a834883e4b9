//! Expands set expressions: one function for each operation on sets.
//!
//! In: the expression of one equation. Out: its set of terms, and diagnostics. Sets stay products of lists.

use std::collections::BTreeSet;

use crate::diagnostic::Diagnostic;
use crate::library::block_layout::{LayoutError, MemoryShare};
use crate::library::candidates::Library;
use crate::library::generators::generator;
use crate::library::generators::generator::factors;
use crate::library::sets::monomials::monomials;
use crate::library::sets::product::Product;
use crate::library::sets::selection_rule::restrictions;
use crate::library::sets::selection_rule::{SelectionRule, flipped};
use crate::library::sets::term_list::LimitExceeded;
use crate::library::sets::term_set::TermSet;
use crate::library::{block_layout, library_errors};
use crate::model::{LibExpr, LibKind, Model, NumberArg, RightSide, Symmetry};
use crate::source::Span;
use crate::term::{Expr, Language, Signal, SignalNames, Term};
use crate::thresholds::LIBRARY;

/// One expansion: the equation it is for, and the diagnostics so far. Methods return `None` after reporting an error.
pub(crate) struct Expansion<'a> {
    model: &'a Model,
    target: Signal,
    share: MemoryShare,
    pub diagnostics: Vec<Diagnostic>,
}

impl<'a> Expansion<'a> {
    /// `memory` is shared by the libraries of all equations.
    pub fn new(model: &'a Model, target: Signal, memory: u64) -> Self {
        let has_library = |r: &RightSide| {
            matches!(
                r,
                RightSide::Search {
                    library: Some(_),
                    ..
                }
            )
        };
        let with = model.equations.iter().filter(|e| has_library(&e.right));
        let of = with.count().max(1) as u64;
        Expansion {
            model,
            target,
            share: MemoryShare {
                bytes: memory / of,
                of,
            },
            diagnostics: Vec::new(),
        }
    }

    /// The whole right side, without the bare target.
    pub fn library(&mut self, e: &LibExpr) -> Option<TermSet> {
        let mut set = self.set(e)?;
        let bare = Term::signal(self.target);
        if set.contains(&bare) {
            self.note_target(e.span);
            set = set.without(&bare);
        }
        if set.count(&SelectionRule::none()) == Some(0) {
            return self.fail(library_errors::empty(e.span));
        }
        Some(set)
    }

    /// The set as a library, pruned by the selection rule.
    pub fn lay_out(&mut self, e: &LibExpr, set: &TermSet, rule: &SelectionRule) -> Option<Library> {
        let library = match block_layout::lay_out(set, rule, self.share.bytes) {
            Ok(library) => library,
            Err(LayoutError::Memory(terms, bytes)) => {
                return self.fail(library_errors::too_large(e.span, terms, bytes, self.share));
            }
            Err(LayoutError::LimitExceeded(why)) => {
                return self.fail(library_errors::limit_exceeded(e.span, why));
            }
        };
        let Some(by) = restrictions(self.model) else {
            return Some(library);
        };
        let target = self.model.name(self.target);
        if library.is_empty() {
            return self.fail(library_errors::all_pruned(e.span, &target, &by));
        }
        let before = set.count(&SelectionRule::none());
        let counts = (library.len() as u128, before);
        self.diagnostics
            .push(library_errors::pruned(e.span, &target, counts, &by));
        if let Some((term, symmetry)) = without_parity(set, rule) {
            let (term, names) = (
                Language(self.model).term(term),
                flipped(self.model, symmetry),
            );
            let note = library_errors::without_parity(e.span, symmetry.span, &term, &names);
            self.diagnostics.push(note);
        }
        Some(library.pruned_from(before))
    }

    /// The slots of the terms that are required; each has to be a candidate.
    pub fn required_slots(&mut self, e: &LibExpr, library: &Library) -> Option<Vec<usize>> {
        let mut slots = Vec::new();
        for part in required_parts(e) {
            let told = self.diagnostics.len();
            let list = self
                .set(part)
                .and_then(|set| self.made(part.span, set.list()));
            // Diagnostics about these terms have been reported for the library.
            self.diagnostics.truncate(told);
            let Some(list) = list else { continue };
            for term in list.terms() {
                match library.contains(term) {
                    Some(slot) => slots.push(slot),
                    None => {
                        let text = Language(self.model).term(term);
                        let bare = *term == Term::signal(self.target);
                        let by = restrictions(self.model).filter(|_| !bare);
                        return self.fail(library_errors::required_left_out(part.span, &text, by));
                    }
                }
            }
            if slots.len() > LIBRARY.required_terms {
                let (found, most) = (slots.len(), LIBRARY.required_terms);
                return self.fail(library_errors::too_many_required(part.span, found, most));
            }
        }
        slots.sort_unstable();
        slots.dedup();
        Some(slots)
    }

    /// Distinct terms of a set expression.
    fn set(&mut self, e: &LibExpr) -> Option<TermSet> {
        match &e.kind {
            LibKind::Term(x) => Some(TermSet::of(vec![self.column(e.span, x)?])),
            LibKind::List(items) => {
                let sets = self.each(items)?;
                self.made(e.span, TermSet::union(sets))
            }
            LibKind::Union(a, b) => {
                let (a, b) = self.both(a, b)?;
                self.made(e.span, TermSet::union([a, b]))
            }
            LibKind::Difference(a, b) => self.difference(e.span, a, b),
            LibKind::Product(a, b) => {
                let (a, b) = self.both(a, b)?;
                self.made(e.span, a.times(&b))
            }
            LibKind::Quotient(a, b) => {
                let a = self.set(a)?;
                let divisor = self.single(b, "/")?.pow(-1.0);
                Some(a.times_term(&divisor))
            }
            LibKind::Power(a, p) => Some(TermSet::of(vec![self.single(a, "^")?.pow(*p)])),
            LibKind::Named { body, .. } | LibKind::Required(body) => self.set(body),
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
    ) -> Option<TermSet> {
        let generator = generator(name)?;
        let atoms = self.atoms(span, args)?;
        let misuse = |m| library_errors::misuse(name_span, generator.usage(), m);
        let (count, exponents) = match (
            generator.count(atoms.len(), numbers),
            generator.exponents(numbers),
        ) {
            (Ok(count), Ok(exponents)) => (count, exponents),
            (Err(m), _) | (_, Err(m)) => return self.fail(misuse(m)),
        };
        if let Some(exponents) = exponents {
            let bytes = count.saturating_mul(block_layout::SLOT_BYTES);
            if exponents.is_bounded() && bytes > u128::from(self.share.bytes) {
                return self.fail(library_errors::too_large(span, count, bytes, self.share));
            }
            return self.made(span, monomials(&factors(&atoms), exponents));
        }
        if count > LIBRARY.listed_terms {
            return self.fail(library_errors::limit_exceeded(
                span,
                LimitExceeded::List(count),
            ));
        }
        match generator.expand(&atoms, numbers) {
            Ok(terms) => Some(TermSet::of(terms)),
            Err(m) => self.fail(misuse(m)),
        }
    }

    /// The arguments of a generator as distinct atoms in the order written, without the target. Numeric factors stay, since
    /// `fourier(1.2*t; 1)` needs them; a generator that multiplies atoms drops them.
    fn atoms(&mut self, span: Span, args: &[LibExpr]) -> Option<Vec<Expr>> {
        let mut atoms: Vec<Expr> = Vec::new();
        let mut seen = BTreeSet::new();
        let bare = Expr::signal(self.target);
        for arg in args {
            let found = match &arg.kind {
                LibKind::Term(x) => vec![self.finite(arg.span, x)?.clone()],
                _ => {
                    let set = self.set(arg)?;
                    let list = self.made(arg.span, set.list())?;
                    list.terms().iter().cloned().map(Expr::from).collect()
                }
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

    fn difference(&mut self, span: Span, a: &LibExpr, b: &LibExpr) -> Option<TermSet> {
        let (left, right) = self.both(a, b)?;
        let (kept, any) = self.made(span, left.difference(&right))?;
        // Removing the target from a shared library is no mistake, although it was dropped before.
        let takes_target = right.contains(&Term::signal(self.target));
        if !any && !takes_target {
            let language = Language(self.model);
            let single = left.single().zip(right.single());
            let single = single.map(|(a, b)| (language.term(&a), language.term(&b)));
            let single = single.as_ref().map(|(a, b)| (a.as_str(), b.as_str()));
            let removed = a.span.after().to(b.span);
            return self.fail(library_errors::removes_nothing(span, removed, single));
        }
        Some(kept)
    }

    /// A written expression as one column, its number dropped with a note.
    fn column(&mut self, span: Span, x: &Expr) -> Option<Term> {
        let (weight, term) = self.finite(span, x)?.clone().into_term();
        if weight == 0.0 {
            return self.fail(library_errors::zero_term(span));
        }
        // A factor of −1 or a constant is not worth a note.
        if weight.abs() != 1.0 && !term.is_one() {
            let (written, column) = (
                Language(self.model).expr(x),
                Language(self.model).term(&term),
            );
            self.diagnostics
                .push(library_errors::number_dropped(span, &written, &column));
        }
        Some(term)
    }

    fn finite<'x>(&mut self, span: Span, x: &'x Expr) -> Option<&'x Expr> {
        if x.is_finite() {
            Some(x)
        } else {
            self.fail(library_errors::not_finite(span))
        }
    }

    fn single(&mut self, e: &LibExpr, operator: &str) -> Option<Term> {
        let set = self.set(e)?;
        match set.single() {
            Some(term) => Some(term),
            None => {
                let found = set
                    .count(&SelectionRule::none())
                    .unwrap_or_else(|| set.upper_bound());
                self.fail(library_errors::needs_one_term(e.span, operator, found))
            }
        }
    }

    /// Both sides, so that errors in both are reported.
    fn both(&mut self, a: &LibExpr, b: &LibExpr) -> Option<(TermSet, TermSet)> {
        let (a, b) = (self.set(a), self.set(b));
        Some((a?, b?))
    }

    fn each(&mut self, items: &[LibExpr]) -> Option<Vec<TermSet>> {
        let sets: Vec<Option<TermSet>> = items.iter().map(|i| self.set(i)).collect();
        sets.into_iter().collect()
    }

    fn made<T>(&mut self, span: Span, made: Result<T, LimitExceeded>) -> Option<T> {
        match made {
            Ok(made) => Some(made),
            Err(why) => self.fail(library_errors::limit_exceeded(span, why)),
        }
    }

    fn note_target(&mut self, span: Span) {
        let name = self.model.name(self.target);
        let note = library_errors::target_dropped(span, &name);
        if !self.diagnostics.contains(&note) {
            self.diagnostics.push(note);
        }
    }

    fn fail<T>(&mut self, d: Diagnostic) -> Option<T> {
        self.diagnostics.push(d);
        None
    }
}

/// The `required(…)` summands of a right side.
fn required_parts(e: &LibExpr) -> Vec<&LibExpr> {
    match &e.kind {
        LibKind::Required(_) => vec![e],
        LibKind::Union(a, b) => [required_parts(a), required_parts(b)].concat(),
        _ => Vec::new(),
    }
}

/// The factor of lowest degree that has no definite parity under some symmetry.
fn without_parity<'a>(
    set: &'a TermSet,
    rule: &'a SelectionRule,
) -> Option<(&'a Term, &'a Symmetry)> {
    let lists = set.products().iter().flat_map(Product::factors);
    let terms = lists.flat_map(|list| list.terms());
    let broken = terms.filter_map(|t| Some((t, rule.broken_by(t)?)));
    broken.min_by(|(a, _), (b, _)| a.degree().total_cmp(&b.degree()).then_with(|| a.cmp(b)))
}
