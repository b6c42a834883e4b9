//! Changes of place or form: statements that move or are joined, calls that become summands, declarations.
//!
//! In: places. Out: the changes of the text, to be made together.

use super::removal::{attribute_span, is_generator};
use super::{FixBuilder, MAX_FIX_BYTES, said};
use crate::ast::{Expr, ExprKind, Side, Sign, StatementKind};
use crate::diagnostic::Fix;
use crate::parse::lexer::{Token, TokenKind, tokenize};
use crate::source::Span;

impl FixBuilder<'_> {
    pub fn with_attribute(&self, at: Span, key: &str, said: &str) -> Option<Fix> {
        let attributes = self.attributes(at)?;
        if let Some(before) = attributes.iter().find(|a| a.key.text == key) {
            let (span, text) = (attribute_span(before), said.to_string());
            return Some(Fix { span, text });
        }
        let sign = if attributes.is_empty() { " :" } else { "," };
        Some(Fix {
            span: self.statement(at)?.span.after(),
            text: format!("{sign} {said}"),
        })
    }

    /// Declares a name with another keyword, on a line of its own if other names share its statement.
    pub fn redeclared(&self, at: Span, keyword: &str) -> Option<Vec<Fix>> {
        let s = self.statement(at)?;
        let StatementKind::Declare {
            names,
            keyword: old,
            ..
        } = &s.kind
        else {
            let text = format!("{keyword} {}", self.text(at));
            return Some(vec![Fix { span: s.span, text }]);
        };
        if names.len() == 1 {
            let end = s.span.start + old.text().len();
            let span = Span::new(at.file, s.span.start, end);
            let text = keyword.to_string();
            return Some(vec![Fix { span, text }]);
        }
        let line = Fix {
            span: s.span.before(),
            text: format!("{keyword} {}\n", self.text(at)),
        };
        Some(vec![line, self.without(at)?])
    }

    pub fn moved(&self, what: Span, above: Span) -> Option<Vec<Fix>> {
        let what = self.statement(what)?.span;
        let above = self.statement_span(above).before();
        let whole = what.to(self.line_end(what));
        let line = Fix {
            span: above,
            text: format!("{}\n", self.text(whole).trim_end()),
        };
        Some(vec![line, self.without_line(what)])
    }

    /// `dx ~ A` and `dx ~ B`: `dx ~ A + B`.
    pub fn joined(&self, first: Span, second: Span) -> Option<Vec<Fix>> {
        let sides = |at: Span| match &self.statement(at)?.kind {
            StatementKind::Equation {
                targets,
                known: false,
                right,
                ..
            } if targets.len() == 1 => Some(right),
            _ => None,
        };
        let (left, right) = (sides(first)?, sides(second)?);
        let added = Fix {
            span: left.span.after(),
            text: format!(" + {}", self.text(right.span)),
        };
        let gone = self.without_line(self.statement_span(second));
        Some(vec![added, gone])
    }

    pub fn renamed(&self, at: Span, old: &str, new: &str) -> Option<Fix> {
        let span = self.statement_span(at);
        let text = self.text(span);
        if text.len() > MAX_FIX_BYTES {
            return None;
        }
        let (tokens, _) = tokenize(span.file, text);
        let own = |t: &&Token| t.kind == TokenKind::Name && t.text == old;
        let edit = |t: &Token| {
            let (start, end) = (span.start + t.start, span.start + t.end);
            (Span::new(span.file, start, end), new.to_string())
        };
        let edits = tokens.iter().filter(own).map(edit).collect();
        let text = self.file.edited(span, edits);
        Some(Fix { span, text })
    }

    /// `<2*trig, x>`: `<trig, x>`.
    pub fn alone(&self, at: Span) -> Option<Fix> {
        let (StatementKind::Equation { right: e, .. }
        | StatementKind::Let { body: e, .. }
        | StatementKind::Function { body: e, .. }) = said(self.statement(at)?)
        else {
            return None;
        };
        let item = item_with(e, at)?;
        Some(Fix {
            span: item.span,
            text: self.summands_as_items(item, at).join(", "),
        })
    }

    /// A term's summands, with the library in place of the one that contains it.
    fn summands_as_items(&self, item: &Expr, at: Span) -> Vec<String> {
        match &item.kind {
            ExprKind::Sum(parts) => {
                let each = |(_, x): &(Sign, Expr)| self.summands_as_items(x, at);
                parts.iter().flat_map(each).collect()
            }
            _ if item.span.holds(at) => vec![self.text(at).to_string()],
            _ => vec![self.text(item.span).to_string()],
        }
    }

    /// `2*required(x)`, `<required(x)>`: `required(x)`; and `A*known(x)`: `A + known(x)`.
    pub fn summand(&self, call: Span) -> Option<Fix> {
        let StatementKind::Equation { right, .. } = said(self.statement(call)?) else {
            return self.argument(call);
        };
        let part = match &right.kind {
            ExprKind::Sum(parts) => {
                let own = parts.iter().find(|(_, x)| x.span.holds(call))?;
                (own.0 == Sign::Plus).then_some(&own.1)?
            }
            _ => right,
        };
        let call_text = self.text(call);
        let others = match &part.kind {
            ExprKind::Product(factors) => {
                let other = |x: &&(Side, Expr)| {
                    x.1.span != call && !matches!(x.1.kind, ExprKind::Number(_))
                };
                self.file.product_of(factors.iter().filter(other))
            }
            ExprKind::List(items) => {
                let other = items.iter().filter(|x| !x.span.holds(call));
                let texts: Vec<&str> = other.map(|x| self.text(x.span)).collect();
                match texts.is_empty() {
                    true => String::new(),
                    false => format!("<{}>", texts.join(", ")),
                }
            }
            _ => return None,
        };
        let text = match others.is_empty() {
            true => call_text.to_string(),
            false => format!("{others} + {call_text}"),
        };
        let span = part.span;
        Some(Fix { span, text })
    }

    /// Replaces a call by the text in its parentheses.
    fn argument(&self, call: Span) -> Option<Fix> {
        let (_, inside) = self.text(call).strip_suffix(')')?.split_once('(')?;
        let text = inside.to_string();
        Some(Fix { span: call, text })
    }
}

/// The innermost item of a list, or argument of a generator, that holds a place.
fn item_with(e: &Expr, at: Span) -> Option<&Expr> {
    let inner = e.children().into_iter().find(|x| x.span.holds(at))?;
    let own = match &e.kind {
        ExprKind::List(_) => Some(inner),
        ExprKind::Call(call) if is_generator(call) => Some(inner),
        _ => None,
    };
    item_with(inner, at).or(own)
}
