//! `unknown`: a constant inside terms that is estimated together with their coefficients.
//!
//! In: the statement. Out: a variable without a column, and the range of its values.

use crate::ast::{Attribute, Expr, ExprKind, UnknownGroup};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::model::{UnknownConstant, Var, VarKind};
use crate::term::VarId;
use crate::units::Unit;

impl Checker<'_> {
    /// `unknown k in 0.1 .. 10, unit "1/s"`
    pub(super) fn declare_unknown(&mut self, group: &UnknownGroup) {
        let range = group.range.and_then(|r| self.unknown_range(r));
        let (unit, per_run) = self.unknown_attributes(group.attributes);
        for name in &group.names {
            let before = self.scope.vars.len();
            self.add_variable(Var {
                name: name.text.clone(),
                kind: VarKind::Unknown,
                order: 0,
                noise: Default::default(),
                noise_time_constant: Default::default(),
                unit: unit.clone(),
                between: None,
                delay: None,
                hidden: false,
                span: Some(name.span),
            });
            if self.scope.vars.len() > before {
                self.scope.unknowns.push(UnknownConstant {
                    var: VarId(before as u16),
                    range,
                    per_run,
                });
            }
        }
    }

    fn unknown_range(&mut self, range: &Expr) -> Option<(f64, f64)> {
        let ExprKind::Range(from, to) = &range.kind else {
            return None;
        };
        let (first, last) = (
            self.constant(from, "the range of an unknown"),
            self.constant(to, "the range of an unknown"),
        );
        let (from, to) = (first?, last?);
        if from < to {
            return Some((from, to));
        }
        self.fail(errors::empty_unknown_range(range.span, from, to))
    }

    fn unknown_attributes(&mut self, attributes: &[Attribute]) -> (Option<Unit>, bool) {
        let (mut unit, mut per_run) = (None, false);
        for (i, a) in attributes.iter().enumerate() {
            let before = attributes.iter().take(i).find(|b| b.key.text == a.key.text);
            if let Some(first) = before {
                let what = format!("`{}`", a.key.text);
                self.say(errors::twice(a.key.span, first.key.span, &what));
                continue;
            }
            match (a.key.text.as_str(), &a.value) {
                ("unit", _) => unit = self.unit(a),
                ("per", Some(run)) if run.as_name() == Some("run") => per_run = true,
                _ => self.say(errors::unknown_attribute_of_unknown(
                    a.key.span,
                    &a.key.text,
                )),
            }
        }
        (unit, per_run)
    }
}
