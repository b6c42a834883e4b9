//! Whether a model is in discrete or in continuous time.
//!
//! In: the statements. Out: the place that makes the model discrete: its first `next`, `lag` or generator of lagged terms. An error for a
//! derivative in such a model.

use crate::ast::{Call, Expr, StatementKind};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::source::Span;

impl Checker<'_> {
    /// Finds the place that makes the model discrete.
    pub fn find_time_kind(&mut self) {
        let mut place: Option<Span> = None;
        for s in self.statements() {
            let exprs: Vec<&Expr> = match &s.kind {
                StatementKind::Equation { targets, right, .. } => {
                    targets.iter().chain([right]).collect()
                }
                StatementKind::Let { body, .. } | StatementKind::Function { body, .. } => {
                    vec![body]
                }
                _ => continue,
            };
            place = place.or_else(|| exprs.into_iter().find_map(|e| self.sample_word(e)));
        }
        self.scope.discrete = place;
    }

    /// The first `next(…)`, `lag(…)` or discrete generator in an expression.
    fn sample_word(&self, e: &Expr) -> Option<Span> {
        let generator = |name: &str| self.generator_named(name);
        let sampled = |call: &Call| {
            let name = call.name.text.as_str();
            ["next", "lag"].contains(&name) || generator(name).is_some_and(|g| g.discrete_only)
        };
        e.find_call(&sampled).map(|found| found.span)
    }

    /// Reports a derivative such as `dx` in a discrete model and returns true; returns false for other names.
    pub fn derivative_in_discrete(&mut self, at: Span, text: &str) -> bool {
        let Some(place) = self.scope.discrete else {
            return false;
        };
        let base = text.trim_end_matches('\'');
        let undotted = base.trim_start_matches('d');
        let declared = |name: &&str| self.scope.signals.get(*name).is_some_and(|s| s.var.0 != 0);
        let mut undotted = (0..base.len() - undotted.len()).filter_map(|k| base.get(k + 1..));
        let dotted = base.len() < text.len() && self.scope.signal(base).is_some();
        let own = dotted.then_some(base);
        let Some(name) = own.or_else(|| undotted.find(declared)) else {
            return false;
        };
        let ours = match self.is_target(at) {
            true => format!("next {name}"),
            false => format!("lag({name}, 1)"),
        };
        self.say(errors::derivative_in_discrete(at, text, &ours, place));
        true
    }
}
