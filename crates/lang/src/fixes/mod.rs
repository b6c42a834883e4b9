//! Fixes that depend on the surrounding text: items with their commas, statements with their lines, unused names.
//!
//! In: diagnostics with their [`Edit`]s, and the file. Out: the [`Fix`]es, each one span and its new text. An edit that cannot be made
//! gives no fix.

mod removal;
mod rewriting;

use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet};

use crate::ast::{File, Statement, StatementKind};
use crate::diagnostic::{Diagnostic, Edit, Fix};
use crate::source::{FileId, Span};

/// Largest number of diagnostics that get such fixes; a text with more errors is hardly a model.
const MAX_DIAGNOSTICS: usize = 1000;
/// Largest number of bytes that one fix may rewrite, to bound the memory of all fixes.
const MAX_FIX_BYTES: usize = 20_000;

pub fn complete(found: &mut [Diagnostic], file: &File) {
    let texts = [file.id]
        .into_iter()
        .chain(file.included.iter().map(|(id, _)| *id));
    let texts: BTreeMap<FileId, FixBuilder> =
        texts.map(|id| (id, FixBuilder::of(file, id))).collect();
    for d in found
        .iter_mut()
        .filter(|d| !d.edits.is_empty())
        .take(MAX_DIAGNOSTICS)
    {
        let place = d.labels.iter().find(|l| l.primary).map(|l| l.span.file);
        let Some(surroundings) = place.and_then(|id| texts.get(&id)) else {
            continue;
        };
        let edits = std::mem::take(&mut d.edits);
        let fixes = edits.into_iter().filter_map(|e| surroundings.fix(e));
        d.fixes.extend(fixes);
    }
}

/// One of the texts of a model.
struct FixBuilder<'a> {
    file: &'a File,
    id: FileId,
    whole: &'a str,
    /// Every word of the text.
    words: OnceCell<BTreeSet<&'a str>>,
}

impl<'a> FixBuilder<'a> {
    fn of(file: &'a File, id: FileId) -> FixBuilder<'a> {
        FixBuilder {
            file,
            id,
            whole: file.text_of(id),
            words: OnceCell::new(),
        }
    }

    fn fix(&self, edits: Vec<Edit>) -> Option<Fix> {
        let mut parts = Vec::new();
        for edit in edits {
            parts.extend(self.parts(edit)?);
        }
        self.merged(parts)
    }

    fn parts(&self, edit: Edit) -> Option<Vec<Fix>> {
        let one = match edit {
            Edit::Replace(span, text) => Fix { span, text },
            Edit::Remove(at) => self.without(at)?,
            Edit::RemoveStatement(at) => self.without_line(self.statement_span(at)),
            Edit::RemoveLine(at) => self.without_line(at),
            Edit::RemoveAttribute(at, key) => self.without_attribute(at, key)?,
            Edit::Attribute(at, key, text) => self.with_attribute(at, key, &text)?,
            Edit::Above(at, line) => Fix {
                span: self.statement(at)?.span.before(),
                text: line + "\n",
            },
            Edit::Below(at, line) => Fix {
                span: self.line_end(self.statement_span(at)),
                text: format!("\n{line}"),
            },
            Edit::Alone(at) => self.alone(at)?,
            Edit::Summand(at) => self.summand(at)?,
            // A name from a range `x1..x12` has no place of its own.
            Edit::Rename(span, name) if self.text(span) == name => Fix {
                span,
                text: self.free_name(&name),
            },
            Edit::Rename(..) => return None,
            Edit::RenameAll(at, old, new) => self.renamed(at, &old, &new)?,
            Edit::Redeclare(at, keyword) => return self.redeclared(at, keyword),
            Edit::Move(what, above) => return self.moved(what, above),
            Edit::Join(first, second) => return self.joined(first, second),
        };
        Some(vec![one])
    }

    /// Merges several changes of this text into one; they must not overlap.
    fn merged(&self, mut parts: Vec<Fix>) -> Option<Fix> {
        if parts.iter().any(|p| p.span.file != self.id) {
            return None;
        }
        parts.sort_by_key(|p| (p.span.start, p.span.end));
        let (first, last) = (parts.first()?.span, parts.last()?.span);
        let span = first.to(last);
        if span.end - span.start > MAX_FIX_BYTES {
            return None;
        }
        let apart = |pair: &[Fix]| matches!(pair, [a, b] if a.span.end <= b.span.start);
        let parts = parts.windows(2).all(apart).then_some(parts)?;
        let edits = parts.into_iter().map(|p| (p.span, p.text)).collect();
        let text = self.file.edited(span, edits);
        Some(Fix { span, text })
    }

    fn text(&self, span: Span) -> &'a str {
        self.file.slice(span)
    }

    /// The statement that holds a place.
    fn statement(&self, at: Span) -> Option<&'a Statement> {
        self.file.statement_at(at)
    }

    /// The place of the statement that holds another place, or that place itself.
    fn statement_span(&self, at: Span) -> Span {
        self.statement(at).map_or(at, |s| s.span)
    }

    /// The name with a numeric suffix that makes it unused.
    fn free_name(&self, name: &str) -> String {
        let letter = |c: char| c.is_alphanumeric() || c == '_';
        let words = self
            .words
            .get_or_init(|| self.whole.split(|c| !letter(c)).collect());
        let mut names = (0..).map(|k| format!("{name}_{k}"));
        let free = names.find(|n| !words.contains(n.as_str()));
        free.unwrap_or_else(|| name.to_string())
    }
}

/// The statement itself, without the range of its index.
fn said(s: &Statement) -> &StatementKind {
    match &s.kind {
        StatementKind::Family { statement, .. } => statement,
        kind => kind,
    }
}
