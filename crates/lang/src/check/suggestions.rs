//! Suggestions for messages in terms of the model: calls with the right number of arguments, names in scope.
//!
//! In: calls and places. Out: texts. Reports nothing.

use crate::ast::{Call, Expr as Ast, ExprKind, StatementKind};
use crate::check::checker::Checker;
use crate::check::vocabulary::GeneratorSignature;
use crate::model::VarKind;
use crate::source::Span;
use crate::thresholds::MESSAGES;

impl Checker<'_> {
    /// The text at a place, or `…` if it is too long for a message: errors in nested calls would each quote all inner ones.
    pub fn shown(&self, at: Span) -> &str {
        const LONGEST: usize = 200;
        let text = self.text(at);
        if text.len() > LONGEST { "…" } else { text }
    }

    /// The name of a call, with its power.
    fn head(&self, call: &Call) -> String {
        let end = call.power.map_or(call.name.span, |(_, at)| at);
        self.text(call.name.span.to(end)).to_string()
    }

    /// A call with its arguments cut to `most` and padded to `least`; `first` stands in if there are none.
    pub fn call_of(&self, call: &Call, (least, most): (usize, usize), first: &str) -> String {
        let given = call.args.iter().take(most).map(|x| self.shown(x.span));
        let mut texts: Vec<&str> = given.collect();
        if texts.is_empty() {
            texts.push(first);
        }
        while texts.len() < least {
            texts.push("1");
        }
        format!("{}({})", self.head(call), texts.join(", "))
    }

    /// A call with the numbers after its `;` turned into arguments, at most `most` in all.
    pub fn call_without_numbers(&self, call: &Call, most: usize) -> String {
        let numbers = call.numbers.iter().flatten();
        let all = call.args.iter().chain(numbers).take(most);
        let texts: Vec<&str> = all.map(|x| self.shown(x.span)).collect();
        format!("{}({})", self.head(call), texts.join(", "))
    }

    /// The first state that the model declares, or else the first name.
    pub fn example_name(&self) -> &str {
        let own = || self.scope.vars.iter().skip(1);
        let state = own().find(|v| v.kind == VarKind::State);
        let first = state.or_else(|| own().next());
        first.map_or("x", |v| v.name.as_str())
    }

    /// A call of a generator with the given arguments, or with the states.
    pub fn generator_example(&self, generator: &GeneratorSignature, call: Option<&Call>) -> String {
        let given = call.into_iter().flat_map(|c| &c.args);
        let mut atoms: Vec<&str> = given.map(|x| self.shown(x.span)).collect();
        if atoms.is_empty() {
            let states = self.scope.vars.iter().filter(|v| v.kind == VarKind::State);
            atoms.extend(states.map(|v| v.name.as_str()).take(MESSAGES.example_names));
        }
        if generator.of_angles {
            atoms.truncate(1);
        }
        let atoms = match atoms.is_empty() {
            true => "x".to_string(),
            false => atoms.join(", "),
        };
        format!("{}({atoms}{})", generator.name, numbers_example(generator))
    }

    /// `lag(sin(x), 1)` as `sin(lag(x, 1))`, with its place.
    pub fn shifted_inside(&self, whole: &Ast, inner: &Ast, by: i32) -> Option<(Span, String)> {
        let mut edits = Vec::new();
        self.shift_names(inner, by, &mut edits)?;
        if edits.is_empty() {
            return None;
        }
        let ours = self.file.edited(inner.ungrouped().span, edits);
        Some((whole.span, ours)).filter(|_| self.shown(inner.span) != "…")
    }

    fn shift_names(&self, e: &Ast, by: i32, edits: &mut Vec<(Span, String)>) -> Option<()> {
        if let Some(name) = e.as_name() {
            match self.scope.signal(name) {
                Some(s) if s.der == 0 => edits.push((e.span, shifted(name, by))),
                None if name == "pi" => {}
                _ => return None,
            }
        }
        let mut parts = e.children().into_iter();
        parts.try_for_each(|x| self.shift_names(x, by, edits))
    }

    /// The `=` between the targets of an equation and its right side.
    pub fn relation_sign(&self, target: Span, right: Span) -> Option<Span> {
        let gap = Span::new(target.file, target.end, right.start);
        let at = gap.start + self.text(gap).find('=')?;
        Some(Span::new(gap.file, at, at + 1))
    }

    /// A declared name with this stem, to suggest for `x[k]`.
    pub fn example_indexed_name(&self, name: &str, index: &Ast) -> String {
        let meant = format!("{name}{}", self.text(index.span));
        let rest = self.scope.signals.range(name.to_string()..);
        let numbered = |n: &str| {
            let digits = n.get(name.len()..).unwrap_or("");
            !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit())
        };
        let own = rest.take_while(|(n, _)| n.starts_with(name));
        let mut own = own.take(MESSAGES.scope_names);
        match self.scope.signals.contains_key(&meant) {
            true => meant,
            false => own
                .find(|(n, _)| numbered(n))
                .map_or_else(|| format!("{name}1"), |(n, _)| n.clone()),
        }
    }

    /// Whether a place is a target of an equation.
    pub fn is_target(&self, at: Span) -> bool {
        let targets = self.file.statement_at(at).map(|s| &s.kind);
        matches!(targets, Some(StatementKind::Equation { targets, .. }) if targets.iter().any(|t| t.span == at))
    }
}

/// Example numbers of a generator, with their `;`.
pub fn numbers_example(generator: &GeneratorSignature) -> &'static str {
    match generator.usage {
        usage if !usage.contains(';') => "",
        usage if usage.contains("..") => "; 1..2",
        usage if usage.contains("degree") => "; 3",
        _ => "; 2",
    }
}

/// A name some samples later, or earlier.
fn shifted(name: &str, by: i32) -> String {
    match by {
        1 => format!("next({name})"),
        _ => format!("lag({name}, {})", -by),
    }
}

/// Whether an expression never needs parentheses.
pub fn is_atom(e: &Ast) -> bool {
    !matches!(
        e.kind,
        ExprKind::Sum(_) | ExprKind::Product(_) | ExprKind::Negate(_) | ExprKind::Power(..)
    )
}
