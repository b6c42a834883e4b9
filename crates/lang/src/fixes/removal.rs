//! Removals from a model, with the comma, colon, sign or line that would be left over.
//!
//! In: a place. Out: the change that removes what the place belongs to.

use super::{FixBuilder, said};
use crate::ast::{Attribute, Call, Expr, ExprKind, Sign, StatementKind};
use crate::diagnostic::Fix;
use crate::source::Span;

impl FixBuilder<'_> {
    /// Removes the attribute, name, argument, entry or term at a place, or else its statement.
    pub fn without(&self, at: Span) -> Option<Fix> {
        let Some(s) = self.statement(at) else {
            return Some(self.without_line(at));
        };
        let whole = || self.without_line(s.span);
        match said(s) {
            StatementKind::Declare {
                names, attributes, ..
            } => {
                let names = names.iter().map(|n| n.span);
                self.without_part(at, attributes, names).or(Some(whole()))
            }
            StatementKind::Unknown {
                names, attributes, ..
            } => {
                let names = names.iter().map(|n| n.span);
                self.without_part(at, attributes, names).or(Some(whole()))
            }
            StatementKind::Limit(keys) => {
                let keys: Vec<Span> = keys.iter().map(attribute_span).collect();
                Some(self.without_one_of(at, &keys).unwrap_or_else(whole))
            }
            StatementKind::PerRun { coefficients, .. } => {
                let all: Vec<Span> = coefficients.iter().map(|e| e.span).collect();
                Some(self.without_one_of(at, &all).unwrap_or_else(whole))
            }
            StatementKind::Function { params, body, .. } if at != s.span => {
                let params: Vec<Span> = params.iter().map(|p| p.span).collect();
                match body.span.holds(at) {
                    true => self.without_term(body, at),
                    false => Some(self.without_one_of(at, &params).unwrap_or_else(whole)),
                }
            }
            StatementKind::Let { body, .. } if body.span.holds(at) => self.without_term(body, at),
            StatementKind::Equation { right, .. } if right.span.holds(at) => {
                self.without_term(right, at)
            }
            StatementKind::Data(entries) if at != s.span => {
                let entry = entries.iter().find(|e| e.span.holds(at))?;
                Some(self.without_entry(entry.span))
            }
            _ => Some(whole()),
        }
    }

    pub fn without_attribute(&self, at: Span, key: &str) -> Option<Fix> {
        let attributes = self.attributes(at)?;
        let found = attributes.iter().find(|a| a.key.text == key)?;
        Some(self.without_item(attribute_span(found)))
    }

    /// The attributes of the declaration at a place.
    pub fn attributes(&self, at: Span) -> Option<&[Attribute]> {
        match &self.statement(at)?.kind {
            StatementKind::Declare { attributes, .. }
            | StatementKind::Unknown { attributes, .. } => Some(attributes),
            _ => None,
        }
    }

    fn without_part(
        &self,
        at: Span,
        attributes: &[Attribute],
        names: impl Iterator<Item = Span>,
    ) -> Option<Fix> {
        let mut spans = attributes.iter().map(attribute_span);
        match spans.find(|s| s.holds(at)) {
            Some(attribute) => Some(self.without_item(attribute)),
            None => self.without_one_of(at, &names.collect::<Vec<Span>>()),
        }
    }

    /// Removes the item at a place; `None` if it is the only one.
    fn without_one_of(&self, at: Span, items: &[Span]) -> Option<Fix> {
        let item = items.iter().find(|i| i.holds(at))?;
        (items.len() > 1).then(|| self.without_item(*item))
    }

    /// Removes an item with its comma, or with the colon before it.
    fn without_item(&self, item: Span) -> Fix {
        let before = self.before(item);
        let after = self.after(item);
        let start = before.trim_end();
        let span = match (
            start.chars().next_back(),
            after.trim_start().strip_prefix(','),
        ) {
            (Some(','), _) => Span::new(item.file, start.len() - 1, item.end),
            (_, Some(rest)) => {
                let rest = rest.trim_start_matches([' ', '\t']);
                Span::new(item.file, item.start, self.whole.len() - rest.len())
            }
            (Some(':'), None) => {
                let start = start.trim_end_matches(':').trim_end().len();
                Span::new(item.file, start, item.end)
            }
            _ => item,
        };
        removed(span)
    }

    /// Removes an entry of a data block, alone on its line or separated from others by `;`.
    fn without_entry(&self, entry: Span) -> Fix {
        let (before, after) = (self.before(entry), self.after(entry));
        let (start, rest) = (before.trim_end(), after.trim_start());
        if start.ends_with(';') {
            return removed(Span::new(entry.file, start.len() - 1, entry.end));
        }
        if let Some(rest) = rest.strip_prefix(';') {
            let rest = rest.trim_start_matches([' ', '\t']);
            let end = self.whole.len() - rest.len();
            return removed(Span::new(entry.file, entry.start, end));
        }
        self.without_line(entry)
    }

    /// Removes a statement with its line and comment; only the statement if it shares the line.
    pub fn without_line(&self, at: Span) -> Fix {
        let before = self.before(at).trim_end_matches([' ', '\t']);
        let end = self.line_end(at).end;
        let alone = before.is_empty() || before.ends_with('\n');
        if !alone || end == at.end && !self.ends_line(end) {
            return removed(at);
        }
        let line_break = usize::from(self.whole.get(end..).is_some_and(|r| r.starts_with('\n')));
        removed(Span::new(at.file, before.len(), end + line_break))
    }

    /// The end of a statement's line, after its comment; the end of the statement if another one follows on that line.
    pub fn line_end(&self, at: Span) -> Span {
        let after = self.after(at);
        let line = after.split('\n').next().unwrap_or("");
        let said = line.trim_start_matches([' ', '\t', '\r']);
        match said.is_empty() || said.starts_with('#') {
            true => Span::new(at.file, at.end + line.len(), at.end + line.len()),
            false => at.after(),
        }
    }

    fn ends_line(&self, end: usize) -> bool {
        let rest = self.whole.get(end..).unwrap_or("");
        rest.is_empty() || rest.starts_with('\n')
    }

    fn before(&self, at: Span) -> &str {
        self.whole.get(..at.start).unwrap_or("")
    }

    fn after(&self, at: Span) -> &str {
        self.whole.get(at.end..).unwrap_or("")
    }

    /// Removes the item of a list, or the summand outside lists, that holds a place. `None` if it is the only one.
    pub fn without_term(&self, e: &Expr, at: Span) -> Option<Fix> {
        match &e.kind {
            ExprKind::Sum(parts) => {
                let place = parts.iter().position(|(_, x)| x.span.holds(at))?;
                let (_, part) = parts.get(place)?;
                self.without_term(part, at)
                    .or_else(|| summand_out(parts, place))
            }
            ExprKind::List(items) => self.without_item_of(items, at),
            ExprKind::Call(call) if is_generator(call) => self.without_item_of(&call.args, at),
            _ => {
                let mut parts = e.children().into_iter();
                self.without_term(parts.find(|x| x.span.holds(at))?, at)
            }
        }
    }

    fn without_item_of(&self, items: &[Expr], at: Span) -> Option<Fix> {
        let item = items.iter().find(|x| x.span.holds(at))?;
        let inside = is_set(item).then(|| self.without_term(item, at)).flatten();
        inside.or_else(|| (items.len() > 1).then(|| self.without_item(item.span)))
    }
}

/// Only generators have numbers after a `;`.
pub fn is_generator(call: &Call) -> bool {
    call.numbers.is_some()
}

/// Whether an item of a list is itself a list or a generator.
fn is_set(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::List(_) => true,
        ExprKind::Call(call) => is_generator(call),
        _ => false,
    }
}

fn summand_out(parts: &[(Sign, Expr)], place: usize) -> Option<Fix> {
    let (_, part) = parts.get(place)?;
    if let Some((_, before)) = place.checked_sub(1).and_then(|i| parts.get(i)) {
        return Some(removed(Span::new(
            part.span.file,
            before.span.end,
            part.span.end,
        )));
    }
    let (sign, next) = parts.get(1)?;
    let span = Span::new(part.span.file, part.span.start, next.span.start);
    let text = match sign {
        Sign::Plus => String::new(),
        Sign::Minus => "-".to_string(),
    };
    Some(Fix { span, text })
}

pub fn attribute_span(a: &Attribute) -> Span {
    let value = a.value.as_ref().map_or(a.key.span, |v| v.span);
    a.key.span.to(value)
}

fn removed(span: Span) -> Fix {
    let text = String::new();
    Fix { span, text }
}
