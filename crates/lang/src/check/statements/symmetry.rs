//! `symmetry`, `limit` and `prefer`: what is known about every term without data.
//!
//! In: these statements. Out: the variables whose signs each symmetry changes, the bound on the degree, and the norms. Prunes no library.

use std::collections::BTreeSet;

use crate::ast::{Attribute, Expr as Ast, ExprKind, Image, StatementKind};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::diagnostic::Edit;
use crate::model::{PreferredNorms, Symmetry};
use crate::source::Span;
use crate::term::{Signal, VarId};
use crate::thresholds::MODEL;

/// The words of `prefer`.
const NORMS: [(&str, PreferredNorms); 2] = [
    ("degree", PreferredNorms::Degree),
    ("plain", PreferredNorms::Plain),
];

impl Checker<'_> {
    pub fn symmetries(&mut self) -> Vec<Symmetry> {
        let mut out = Vec::new();
        for s in self.statements() {
            let StatementKind::Symmetry { names, image } = &s.kind else {
                continue;
            };
            let before = self.found.len();
            match self.symmetry(names, image) {
                Some(flipped) => out.push(Symmetry {
                    flipped,
                    span: s.span,
                }),
                None => self.mend_symmetry(s.span, names, before),
            }
        }
        if let Some(beyond) = out.get(MODEL.symmetries) {
            self.say(errors::too_many_symmetries(beyond.span, MODEL.symmetries));
        }
        out
    }

    /// `x, y -> -(x, y)`, or with separate signs `x, y -> -x, -y`.
    fn symmetry(&mut self, names: &[Ast], image: &Image) -> Option<Vec<VarId>> {
        let left = self.flipped(names)?;
        let negated = |e: &Ast| match &e.kind {
            ExprKind::Negate(x) => Some(x.ungrouped().clone()),
            _ => None,
        };
        let items = match image.flipped {
            true => Some(image.items.clone()),
            false => image.items.iter().map(negated).collect::<Option<Vec<_>>>(),
        };
        let whole = names.first()?.span.to(names.last()?.span);
        let Some(items) = items else {
            return self.fail(errors::not_a_flip(image.span, self.text(whole)));
        };
        let right = self.flipped(&items)?;
        let set = |vars: &[VarId]| vars.iter().copied().collect::<BTreeSet<VarId>>();
        if set(&left) != set(&right) {
            return self.fail(errors::flips_other_names(
                image.span,
                whole,
                self.text(whole),
            ));
        }
        Some(left)
    }

    /// Adds a fix to the errors found since `before`: the whole statement, with the names that can change their signs.
    fn mend_symmetry(&mut self, statement: Span, names: &[Ast], before: usize) {
        let (mut flipped, mut seen) = (Vec::new(), BTreeSet::new());
        for e in names {
            if matches!(e.kind, ExprKind::Range(..)) {
                flipped.push(self.text(e.span));
                continue;
            }
            let named = e.find(&|e| e.as_name().is_some());
            let signal = named
                .and_then(Ast::as_name)
                .and_then(|n| self.scope.signal(n));
            let time = |s: &Signal| s.var == VarId::TIME && self.scope.discrete.is_some();
            let own = signal
                .filter(|s| !time(s))
                .and_then(|s| self.scope.var(s.var));
            if let Some(v) = own.filter(|v| seen.insert(v.name.as_str())) {
                flipped.push(v.name.as_str());
            }
        }
        let names = flipped.join(", ");
        let edit = match flipped.as_slice() {
            [] => Edit::RemoveStatement(statement),
            _ => Edit::Replace(statement, format!("symmetry {names} -> -({names})")),
        };
        let found = self.found.get_mut(before..).into_iter().flatten();
        for d in found.filter(|d| d.code == "symmetry") {
            d.edits.push(vec![edit.clone()]);
        }
    }

    /// The variables of names and ranges, each once.
    fn flipped(&mut self, names: &[Ast]) -> Option<Vec<VarId>> {
        let mut out: Vec<VarId> = Vec::new();
        let mut complete = true;
        for e in names {
            let texts = match &e.kind {
                ExprKind::Name(text) => Some(vec![text.clone()]),
                ExprKind::Range(from, to) => self.expand_range(e.span, from, to),
                _ => self.fail(errors::not_a_flipped_name(e.span)),
            };
            complete &= texts.is_some();
            for text in texts.unwrap_or_default() {
                match self.flipped_name(e.span, &text) {
                    Some(var) if out.contains(&var) => {}
                    Some(var) => out.push(var),
                    None => complete = false,
                }
            }
        }
        complete.then_some(out)
    }

    fn flipped_name(&mut self, span: Span, text: &str) -> Option<VarId> {
        let Some(s) = self.scope.signal(text) else {
            if text == "pi" || self.scope.lets.contains_key(text) {
                return self.fail(errors::not_a_flipped_name(span));
            }
            return self.unknown_name(span, text);
        };
        if s.der > 0 {
            let name = self.scope.var(s.var).map_or("", |v| v.name.as_str());
            let d = errors::flipped_derivative(span, text, name);
            return self.fail(d);
        }
        if s.var == VarId::TIME && self.scope.discrete.is_some() {
            return self.fail(errors::flipped_samples(span));
        }
        Some(s.var)
    }

    /// The bound of `limit degree 4`.
    pub fn degree_limit(&mut self) -> Option<f64> {
        let mut found: Option<(f64, Span)> = None;
        for s in self.statements() {
            let StatementKind::Limit(keys) = &s.kind else {
                continue;
            };
            for key in keys {
                if key.key.text != "degree" {
                    let d = errors::unknown_limit(key.key.span, &key.key.text);
                    self.say(d);
                    continue;
                }
                let Some(bound) = self.bound(key) else {
                    continue;
                };
                match found {
                    Some((_, first)) => {
                        self.say(errors::twice(key.key.span, first, "limit on the degree"));
                    }
                    None => found = Some((bound, key.key.span)),
                }
            }
        }
        found.map(|(bound, _)| bound)
    }

    /// The norms of `prefer degree` or `prefer plain`.
    pub fn preferred_norms(&mut self) -> PreferredNorms {
        let mut found: Option<(PreferredNorms, Span)> = None;
        for s in self.statements() {
            let StatementKind::Prefer(key) = &s.kind else {
                continue;
            };
            let norms = NORMS.iter().find(|(word, _)| *word == key.key.text);
            let Some((_, norms)) = norms.filter(|_| key.value.is_none()) else {
                let d = errors::unknown_norm(key, &NORMS.map(|(word, _)| word));
                self.say(d);
                continue;
            };
            match found {
                Some((_, first)) => self.say(errors::twice(s.span, first, "preference")),
                None => found = Some((*norms, s.span)),
            }
        }
        found.map_or(PreferredNorms::Any, |(norms, _)| norms)
    }

    fn bound(&mut self, a: &Attribute) -> Option<f64> {
        let Some(value) = &a.value else {
            let at = (a.key.span, a.key.span);
            let d = errors::attribute_value(at, "degree", "a number", &["degree 4"]);
            return self.fail(d.help("write `limit degree 4`"));
        };
        let bound = self.constant(value, "`limit degree`")?;
        if (0.0..=MODEL.degree).contains(&bound) {
            return Some(bound);
        }
        self.fail(errors::degree_limit(value.span, bound))
    }
}
